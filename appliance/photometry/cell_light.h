// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "appliance/photometry/photometry_input.h"
#include "appliance/photometry/response_solve.h"

namespace cyclorama::photometry {

/// Linear light, per unit of exposure, of one cell of a projector's picture as seen from one stop of the turntable. For
/// a camera without colour all channels are equal.
struct CellLight {
  std::size_t cell = 0;
  Eigen::Vector3d black = Eigen::Vector3d::Zero();
  Eigen::Vector3d black_sigma = Eigen::Vector3d::Zero();
  Eigen::Matrix3d primaries = Eigen::Matrix3d::Zero();  ///< Columns: red, green, blue at full code, above black.
  bool has_primaries = false;
  Eigen::Vector3d white = Eigen::Vector3d::Zero();  ///< Above black.
  bool has_white = false;
  double sigma = 0.0;  ///< Relative standard deviation of white or, without white, of the primaries' sum.
};

/// Returns the light of the cells for which black and at least one bright light were seen. Reentrant.
[[nodiscard]] std::vector<CellLight> cell_lights(const PhotometryInput& input, const ProjectorView& view,
                                                 const CameraResponse& camera,
                                                 const std::array<ChannelResponse, 3>& curves);

}  // namespace cyclorama::photometry
