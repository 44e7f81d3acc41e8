// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/tools/camera_options.h"

#include <fmt/format.h>

#include <numbers>

namespace cyclorama::tools {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

Error refuse(std::string what) { return Error(ErrorCode::kInvalidArgument, std::move(what)); }

}  // namespace

void add_camera_options(CLI::App* command, CameraOptions* options) {
  command->add_option("--camera", options->camera, "The picture's projection")
      ->check(CLI::IsMember({"panorama", "perspective", "fisheye", "equirectangular"}))
      ->capture_default_str();
  command->add_option("--field-deg,--azimuth-deg", options->field_deg,
                      "Width of the field of view; default: 360, fisheye 180, perspective 90");
  command->add_option("--tilt-deg", options->tilt_deg, "Tilt upwards; only for fisheye and perspective")
      ->capture_default_str();
  command->add_option("--stereo", options->stereo, "Eyes; over-under puts the left eye's picture above the right eye's")
      ->check(CLI::IsMember({"mono", "left", "right", "over-under"}))
      ->capture_default_str();
  command->add_option("--eye-distance-m", options->eye_distance_m, "Distance between the pupils")
      ->capture_default_str();
  command->add_option("--screen-distance-m,--screen-radius-m", options->screen_distance_m,
                      "Distance from the eyes to the screen, where they converge");
}

Result<Projection> projection_of(const CameraOptions& options, int width_px, int height_px) {
  Projection projection;
  const bool perspective = options.camera == "perspective";
  const bool fisheye = options.camera == "fisheye";
  const double field = options.field_deg.value_or(perspective ? 90.0 : fisheye ? 180.0 : 360.0) * kDegree;
  const double tilt = options.tilt_deg * kDegree;
  const double half_height = 0.5 * field * height_px / width_px;
  if (tilt != 0.0 && !perspective && !fisheye) return refuse("--tilt-deg needs a fisheye or perspective camera");
  if (perspective) {
    // Beyond half a turn the tangent would describe a different picture.
    if (!(field > 0.0 && field < std::numbers::pi)) {
      return refuse(
          fmt::format("--field-deg is {}; that of a perspective must be above 0 and below 180", field / kDegree));
    }
    projection.shape = Perspective::from_field(width_px, height_px, field, tilt);
  } else if (fisheye) {
    projection.shape = Fisheye{width_px, height_px, field, tilt};
  } else if (options.camera == "equirectangular") {
    projection.shape = Equirectangular{width_px, height_px, field, half_height, -half_height};
  } else {
    projection.shape = Panorama{width_px, height_px, field, half_height, -half_height};
  }
  if (options.stereo != "mono") {
    if (!options.screen_distance_m) {
      return refuse(
          "--stereo needs --screen-distance-m, the distance at which the eyes converge; 'inf' for parallel eyes");
    }
    Viewing& viewing = projection.viewing;
    viewing.eyes = options.stereo == "left" ? Eyes::kLeft : options.stereo == "right" ? Eyes::kRight : Eyes::kOverUnder;
    viewing.eye_distance_m = options.eye_distance_m;
    viewing.screen_distance_m = *options.screen_distance_m;
  }
  TRY(projection.validate());
  return projection;
}

}  // namespace cyclorama::tools
