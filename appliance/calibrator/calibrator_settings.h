// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "appliance/scan/device_lines.h"
#include "common/base/result.h"
#include "common/config/config.h"

namespace cyclorama::calibrator {

/// Valid ranges of a calibrator's numbers, in the file and on the command line.
struct CalibratorRanges {
  static constexpr Range kFieldOfView_deg{5, 150};
  static constexpr Range kPitch_deg{-60, 60};
  static constexpr Range kSettle_ms{0, 2000};
  static constexpr Range kMaxExposure_ms{1, 5000};
  static constexpr Range kWatchExposure_ms{0.1, 1000};
  static constexpr Range kWatch_hz{0.05, 10};
  static constexpr Range kLatency_ms{0, 1000};
};

/// All settings of cyclorama-calibrator's devices. With the defaults the program starts; devices that are missing are
/// reported when a calibration is requested.
struct CalibratorSettings {
  std::string listen = "[::1]:7410";
  std::vector<scan::PatternDisplay> displays{};  ///< Empty: the display of this computer.
  double settle_s = 0.1;                         ///< Delay from a projector's signal to its light.
  std::string turntable = "manual";              ///< Argument for make_turntable().

  std::string camera = "v4l2:";  ///< Camera on the turntable; argument for make_camera().
  /// Lens file of the camera on the turntable; empty: the calibration's camera.json if it belongs to this camera.
  std::filesystem::path lens{};
  /// Horizontal field of view, used if the lens is unknown.
  double field_of_view_rad = 70.0 * std::numbers::pi / 180.0;
  double pitch_rad = 0.0;  ///< Approximate upward tilt.
  double max_exposure_s = 0.25;

  std::vector<scan::CameraSource> watch{};  ///< Fixed cameras.
  /// Folder with a NAME.json for each camera whose lens the calibration lacks; empty: none.
  std::filesystem::path lenses{};
  double watch_exposure_s = 1.0 / 30.0;
  double watch_hz = 4.0;
  double latency_s = 0.03;  ///< Delay from a refresh of the display to the projector's light.

  /// Reads calibrator.toml, whose keys docs/reference/settings.md lists. Lens files are in the same folder: the file
  /// that [camera] names, and cameras/NAME.json; they are not read here. Errors: kBadData with file, line and remedy;
  /// those of read_file().
  static Result<CalibratorSettings> read(const std::filesystem::path& path);
  static Result<CalibratorSettings> parse(std::string_view text, std::string name);

  /// Checks that the lens files that exist can be read; fixed cameras may have none. Errors: those of read_camera(),
  /// with the camera's name.
  [[nodiscard]] Status check_lenses() const;
};

}  // namespace cyclorama::calibrator
