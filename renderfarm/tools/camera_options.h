// SPDX-License-Identifier: Apache-2.0
/// The options for a picture's projection: --camera and the options that refine it.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "common/base/result.h"
#include "common/geometry/projection.h"

namespace cyclorama::tools {

struct CameraOptions {
  std::string camera = "panorama";
  std::optional<double> field_deg;
  double tilt_deg = 0.0;
  std::string stereo = "mono";
  double eye_distance_m = 0.063;
  std::optional<double> screen_distance_m;
};

void add_camera_options(CLI::App* command, CameraOptions* options);

/// Returns the projection for a picture with square pixels; the size is that of each eye. Errors: kInvalidArgument,
/// with one sentence, if an option is invalid or does not apply to the camera.
Result<Projection> projection_of(const CameraOptions& options, int width_px, int height_px);

}  // namespace cyclorama::tools
