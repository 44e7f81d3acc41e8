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

/// Observations of one projector from one stop of the turntable.
struct ProjectorView {
  std::size_t projector = 0;  ///< Index in PhotometryInput::projectors.
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
  /// Centre of the camera's vignetting: the pixel on the optical axis; if absent, the picture's middle. An error of a
  /// hundredth of the width changes the light by a few percent from one end of the picture to the other.
  std::optional<Eigen::Vector2d> camera_centre_px{};
  bool has_colour = true;          ///< If false, all three channels are the same and colours are not corrected.
  double code_step = 1.0 / 255.0;  ///< Step between adjacent camera codes.
  std::vector<PhotometricProjector> projectors;
  std::vector<ProjectorView> views;

  /// Checks the values. Errors: kInvalidArgument, with the projector or view at fault and the remedy.
  [[nodiscard]] Status validate() const;
};

}  // namespace cyclorama::photometry
