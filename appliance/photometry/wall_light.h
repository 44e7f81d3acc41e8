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

/// Luminance weights of the camera's linear channels: those of ITU-R BT.709, an approximation for the camera's filters.
inline const Eigen::Vector3d kCameraLuminance{0.2126, 0.7152, 0.0722};

/// Light of one projector, as measured on the camera's optical axis.
struct ProjectorLighting {
  PictureField log_white;  ///< Natural logarithm of white's luminance above black, per unit of exposure.
  Eigen::Matrix3d primaries = Eigen::Matrix3d::Identity();  ///< Columns: red, green, blue; white's luminance is 1.
  /// Light at code 0, as a fraction of white's luminance at the same pixel.
  Eigen::Vector3d black_level = Eigen::Vector3d::Zero();
  double white_boost = 1.0;    ///< White over the sum of red, green and blue; not 1 with a white segment.
  double colour_spread = 0.0;  ///< Relative RMS variation of the primaries over the picture.

  [[nodiscard]] double white_at(const Eigen::Vector2d& pixel) const;
};

struct WallLighting {
  std::vector<ProjectorLighting> projectors;
  /// Colour of the ambient light: a linear function of (x, y, z, 1), where (x, y, z) is the direction.
  Eigen::Matrix<double, 3, 4> ambient = Eigen::Matrix<double, 3, 4>::Zero();
  Eigen::Vector3d vignetting =
      Eigen::Vector3d::Zero();  ///< Camera's log(light): coefficients of r^2, r^4, r^6; r is 1 in a corner.
  /// False if no cell was seen from two stops; the camera's vignetting is then attributed to the projectors.
  bool has_vignetting = false;
  double unexplained = 0.0;  ///< Relative RMS difference of white's readings from the model.

  /// Returns the ambient light in a direction; never negative.
  [[nodiscard]] Eigen::Vector3d ambient_at(const Eigen::Vector3d& direction) const;
};

/// Computes the light of all projectors from the readings. `curves` are per projector and channel. Errors: kBadData if
/// a projector's white was seen nowhere. Reentrant.
Result<WallLighting> wall_lighting(const PhotometryInput& input, const SolvedResponses& responses,
                                   const std::vector<std::array<ChannelResponse, 3>>& curves,
                                   const std::vector<InverseMap>& inverses);

}  // namespace cyclorama::photometry
