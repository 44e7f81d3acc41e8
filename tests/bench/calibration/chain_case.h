// SPDX-License-Identifier: Apache-2.0
/// A calibration of a simulated museum from beginning to end, and what its truth says of it.
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
  std::string name;  ///< A preset's.
  simulated::PresetOptions museum{};
  std::uint32_t seed = 1;
  scan::ViewSettings view{};
  int directions = 0;
  bool with_wall = true;
  bool keeps_folder = false;  ///< What was measured stays there.
};

/// Times of the outcome are this process's processor time: the machine may be shared, and solving has one thread.
struct ChainResult {
  MuseumScore score;
  scan::CalibrationOutcome outcome;
  SeamScore seams{};         ///< Of the corrected wall; where the outcome has light.
  SeamScore seams_before{};  ///< Without its correction: blended, and taken for sRGB.
  double response_rms = 0.0;
  double museum_s = 0.0;            ///< Of the museum's clock: what a visitor would wait.
  double patterns_exposed_s = 0.0;  ///< Of that, with the shutter open for places,
  double light_exposed_s = 0.0;     ///< and for brightness and colours. The rest: projectors, turntable, read-out.
  std::size_t directions = 0;
};

/// What an installer knows of a preset's camera.
struct KnownCamera {
  double field_of_view_rad;
  double pitch_rad;
};
[[nodiscard]] KnownCamera camera_of_preset(const std::string& name);

/// `folder` is made, and emptied afterwards, unless it is to be kept.
Result<ChainResult> run_chain(const ChainCase& chain, const std::filesystem::path& folder);

}  // namespace cyclorama
