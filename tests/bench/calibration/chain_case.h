// SPDX-License-Identifier: Apache-2.0
/// A complete calibration of a simulated museum, and its score against the truth.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "appliance/scan/calibration_run.h"
#include "drivers/simulated/museum/presets.h"
#include "tests/data_sets/photometry_museum.h"
#include "tests/support/museum_score.h"

namespace cyclorama {

struct ChainCase {
  std::string name;  ///< Name of a preset.
  simulated::PresetOptions museum{};
  std::uint32_t seed = 1;
  scan::ViewSettings view{};
  int directions = 0;
  bool with_wall = true;
  std::vector<std::string> as_sold{};  ///< Kinds of simulated::add_as_sold().
  bool keeps_folder = false;  ///< Keeps the measurements in the folder.
};

/// The outcome's times are processor times of this process, since the machine may be shared and solving has one thread.
struct ChainResult {
  MuseumScore score;
  scan::CalibrationOutcome outcome;
  SeamScore seams{};         ///< Seams of the corrected wall, if the outcome has photometry.
  SeamScore seams_before{};  ///< Seams without the correction: blended, with the response taken for sRGB.
  double response_rms = 0.0;
  double museum_s = 0.0;            ///< Duration on the museum's clock, as a person in the museum would wait.
  double patterns_exposed_s = 0.0;  ///< Part with the shutter open for patterns of position.
  /// Part with the shutter open for brightness and colours. The rest: projectors, turntable, read-out.
  double light_exposed_s = 0.0;
  std::size_t directions = 0;
};

/// Properties of a preset's camera that an installer can state.
struct KnownCamera {
  double field_of_view_rad;
  double pitch_rad;
};
[[nodiscard]] KnownCamera camera_of_preset(const std::string& name);

/// Creates `folder`, and empties it afterwards unless it is to be kept.
Result<ChainResult> run_chain(const ChainCase& chain, const std::filesystem::path& folder);

}  // namespace cyclorama
