// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "appliance/calibration/measured_lens.h"
#include "appliance/tags/tag_detector.h"
#include "appliance/tracker/markerless/body_tracker.h"
#include "appliance/tracker/tag_tracking.h"
#include "common/base/result.h"
#include "common/room/pinhole.h"

namespace cyclorama::tracker {

/// The camera's lens, which is known before the size of its pictures is.
struct LensSettings {
  double field_of_view_rad = 1.0471975511965976;  ///< Of the picture's width; 60°.
  /// Calibrated values, in pixels, replace the field of view; the centre is the picture's middle when not given.
  std::optional<double> focal_px;
  std::optional<Eigen::Vector2d> centre_px;
  /// Of camera.json, with its distortion; replaces all of the above.
  std::optional<calibration::MeasuredLens> calibrated;
};

enum class SteerBy { kWand, kBody };

/// Everything that cyclorama-tracker is told. The defaults are those of the demo on one machine.
struct TrackerSettings {
  std::string camera = "simulated";  ///< For make_camera().
  std::string name;                  ///< What the tour calls this camera; the camera's own id when empty.
  LensSettings lens;
  SteerBy steer_by = SteerBy::kWand;
  BodySettings body;              ///< Of visitors without a pattern.
  BackgroundSettings background;  ///< Likewise.
  tags::DetectorSettings detector;
  TrackingSettings tracking;
  std::string tour = "[::1]:7403";
  std::string listen = "[::1]:7405";
  std::string osc;   ///< Poses go here as well, as Open Sound Control; empty: nowhere.
  std::string vrpn;  ///< And as VRPN's datagrams.

  /// tracker.toml, whose keys docs/reference/settings.md lists; the wand files that it names lie beside it.
  /// kBadData  file, line and remedy.     Others as read_file().
  static Result<TrackerSettings> read(const std::filesystem::path& path);
  static Result<TrackerSettings> parse(std::string_view text, std::string name);
};

/// Without distortion: straightened() makes detections of a calibrated lens fit it. A calibrated lens of pictures of
/// another shape is left aside. Preconditions: the picture is not empty.
[[nodiscard]] Pinhole lens_for(const LensSettings& settings, int width_px, int height_px);

}  // namespace cyclorama::tracker
