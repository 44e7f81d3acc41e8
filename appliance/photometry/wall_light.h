// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "appliance/photometry/inverse_map.h"
#include "appliance/photometry/photometry_input.h"
#include "appliance/photometry/picture_field.h"
#include "appliance/photometry/response_solve.h"
#include "common/base/result.h"

namespace cyclorama::photometry {

/// How much a linear colour of the camera counts as brightness. The camera's filters are not the eye's: these are about
/// ITU-R BT.709's.
inline const Eigen::Vector3d kCameraLuminance{0.2126, 0.7152, 0.0722};

/// What one projector lights, as the camera would see it with the middle of its lens.
struct ProjectorLighting {
  PictureField log_white;  ///< Natural logarithm of white's luminance above black, per unit of exposure.
  Eigen::Matrix3d primaries = Eigen::Matrix3d::Identity();  ///< Columns: red, green, blue; white's luminance is 1.
  Eigen::Vector3d black_level = Eigen::Vector3d::Zero();    ///< Colour at code 0, in parts of white's luminance there.
  double white_boost = 1.0;    ///< White over the sum of red, green and blue: not 1 with a white segment.
  double colour_spread = 0.0;  ///< How far primaries differ over the picture: relative rms.

  [[nodiscard]] double white_at(const Eigen::Vector2d& pixel) const;
};

struct WallLighting {
  std::vector<ProjectorLighting> projectors;
  /// Colour of what shines besides, by direction (x, y, z, 1): ambient light.
  Eigen::Matrix<double, 3, 4> ambient = Eigen::Matrix<double, 3, 4>::Zero();
  Eigen::Vector3d vignetting = Eigen::Vector3d::Zero();  ///< Of log(light) by r^2, r^4, r^6; r is 1 in a corner.
  bool has_vignetting = false;  ///< Else no cell was seen from two stops, and it counts as the projectors'.
  double unexplained = 0.0;     ///< Relative rms of white's readings.

  /// Below 0 never.
  [[nodiscard]] Eigen::Vector3d ambient_at(const Eigen::Vector3d& direction) const;
};

/// kBadData  a projector whose white was seen nowhere.   `curves`: per projector and channel. Reentrant.
Result<WallLighting> wall_lighting(const PhotometryInput& input, const SolvedResponses& responses,
                                   const std::vector<std::array<ChannelResponse, 3>>& curves,
                                   const std::vector<InverseMap>& inverses);

}  // namespace cyclorama::photometry
