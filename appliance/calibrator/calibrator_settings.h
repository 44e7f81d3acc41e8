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

/// What a calibrator's numbers may be, in a file as on the command line.
struct CalibratorRanges {
  static constexpr Range kFieldOfView_deg{5, 150};
  static constexpr Range kPitch_deg{-60, 60};
  static constexpr Range kSettle_ms{0, 2000};
  static constexpr Range kMaxExposure_ms{1, 5000};
  static constexpr Range kWatchExposure_ms{0.1, 1000};
  static constexpr Range kWatch_hz{0.05, 10};
  static constexpr Range kLatency_ms{0, 1000};
};

/// Everything that cyclorama-calibrator is told of its devices. The defaults are those of a museum that has not said
/// anything yet: it starts, and says what it lacks when it is to calibrate.
struct CalibratorSettings {
  std::string listen = "[::1]:7410";
  std::vector<scan::PatternDisplay> displays{};  ///< None: that of this computer.
  double settle_s = 0.1;                         ///< From a projector's signal to its light.
  std::string turntable = "manual";              ///< For make_turntable().

  std::string camera = "v4l2:";  ///< On the turntable; for make_camera().
  std::filesystem::path lens{};  ///< Of it; empty: the calibration's camera.json where that is of it.
  double field_of_view_rad = 70.0 * std::numbers::pi / 180.0;  ///< Of its picture's width, where its lens is not known.
  double pitch_rad = 0.0;                                      ///< How far it looks up, about.
  double max_exposure_s = 0.25;

  std::vector<scan::CameraSource> watch{};  ///< Fixed cameras.
  std::filesystem::path lenses{};           ///< Theirs: NAME.json, where the calibration has none; empty: nowhere.
  double watch_exposure_s = 1.0 / 30.0;
  double watch_hz = 4.0;
  double latency_s = 0.03;  ///< From a refresh of the display to the projector's light.

  /// calibrator.toml, whose keys docs/reference/settings.md lists. Lenses lie beside it: what [camera] names, and
  /// cameras/NAME.json. Reads none of them.
  /// kBadData  file, line and remedy.     Others as read_file().
  static Result<CalibratorSettings> read(const std::filesystem::path& path);
  static Result<CalibratorSettings> parse(std::string_view text, std::string name);

  /// That lenses which are there can be read; fixed cameras may have none. Errors of read_camera(), with whose it is.
  [[nodiscard]] Status check_lenses() const;
};

}  // namespace cyclorama::calibrator
