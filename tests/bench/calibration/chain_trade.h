// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "tests/bench/records.h"

namespace cyclorama {

/// Varies one parameter of a calibration at a time, prints a table, and writes the input of trade.py. Returns an exit
/// code.
int trade(bool is_quick, unsigned seeds, const std::filesystem::path& folder, const std::filesystem::path& json_file,
          Records* records);

}  // namespace cyclorama
