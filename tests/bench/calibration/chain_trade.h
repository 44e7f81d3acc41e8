// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "tests/bench/records.h"

namespace cyclorama {

/// Sweeps one knob of a calibration at a time, prints a table, and writes what trade.py draws. Returns what main does.
int trade(bool is_quick, unsigned seeds, const std::filesystem::path& folder, const std::filesystem::path& json_file,
          Records* records);

}  // namespace cyclorama
