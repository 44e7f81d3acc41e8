// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

#include "tests/bench/records.h"

namespace cyclorama {

/// Calibrates museums with optics, cameras, walls and rooms as they are sold: nothing, each kind alone, and all. Prints
/// a table, writes the figures to `json`, and returns the exit status. A result is confidently wrong if the calibration
/// was accepted, and is beyond the goal and far beyond what it states of itself.
int distorted(bool is_quick, std::uint32_t seed, const std::filesystem::path& folder, const std::filesystem::path& json,
              Records* records);

}  // namespace cyclorama
