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

/// The camera's lens, before the size of its pictures is known.
struct LensSettings {
  double field_of_view_rad = 1.0471975511965976;  ///< Horizontal field of view; 60°.
  /// Calibrated values in pixels; they replace the field of view. The centre defaults to the picture's middle.
  std::optional<double> focal_px;
  std::optional<Eigen::Vector2d> centre_px;
  /// Lens of camera.json, with its distortion; replaces the members above.
  std::optional<calibration::MeasuredLens> calibrated;
};

enum class SteerBy { kWand, kBody };

/// All settings of cyclorama-tracker. The defaults suit the demo on one machine.
struct TrackerSettings {
  std::string camera = "simulated";  ///< Argument for make_camera().
  std::string name;                  ///< The camera's name in the tour; empty: the camera's own id.
  LensSettings lens;
  SteerBy steer_by = SteerBy::kWand;
  BodySettings body;              ///< For visitors without a pattern.
  BackgroundSettings background;  ///< For visitors without a pattern.
  tags::DetectorSettings detector;
  TrackingSettings tracking;
  std::string tour = "[::1]:7403";
  std::string listen = "[::1]:7405";
  std::string osc;   ///< Address that also receives poses, as Open Sound Control; empty: none.
  std::string vrpn;  ///< Address that receives poses as VRPN datagrams; empty: none.

  /// Reads tracker.toml, whose keys docs/reference/settings.md lists; the wand files that it names are in the same
  /// folder. Errors: kBadData with file, line and remedy; those of read_file().
  static Result<TrackerSettings> read(const std::filesystem::path& path);
  static Result<TrackerSettings> parse(std::string_view text, std::string name);
};

/// Returns a lens without distortion: straightened() adapts detections with a calibrated lens to it. A calibrated lens
/// of another aspect ratio is ignored. Precondition: the picture is not empty.
[[nodiscard]] Pinhole lens_for(const LensSettings& settings, int width_px, int height_px);

}  // namespace cyclorama::tracker
