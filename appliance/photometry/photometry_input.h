// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "appliance/calibration/measured_map.h"
#include "appliance/photometry/light_cells.h"
#include "common/base/result.h"

namespace cyclorama::photometry {

/// What the camera saw of one projector while it stood at one stop.
struct ProjectorView {
  std::size_t projector = 0;  ///< Counts PhotometryInput::projectors.
  CameraCells cells;
  std::vector<LightReading> readings;
};

struct PhotometricProjector {
  std::string name;
  calibration::MeasuredMap map;
};

struct PhotometryInput {
  int camera_width_px = 0;
  int camera_height_px = 0;
  /// Where the camera's axis meets its picture: it darkens from there on. Nothing: the middle. A hundredth of the width
  /// beside it is a few percent of light from one end of the picture to the other.
  std::optional<Eigen::Vector2d> camera_centre_px{};
  bool has_colour = true;          ///< Else all three channels are the same, and colours stay as they are.
  double code_step = 1.0 / 255.0;  ///< Of the camera's codes.
  std::vector<PhotometricProjector> projectors;
  std::vector<ProjectorView> views;

  /// kInvalidArgument  with the projector or view at fault, and what to do.
  [[nodiscard]] Status validate() const;
};

}  // namespace cyclorama::photometry
