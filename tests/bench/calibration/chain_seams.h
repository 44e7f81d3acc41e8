// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "tests/bench/calibration/chain_case.h"

namespace cyclorama {

/// Where steps at seams and errors of weights come from: the same wall with what was measured, and with the truth in
/// place of the maps, of the light, and of both; and with other slopes. `folder` holds the case's calibration, as
/// run_chain() keeps it. Prints a table, and a CSV of all borders to `csv` unless that is empty. An exit code.
int explain_seams(const ChainCase& chain, const std::filesystem::path& folder, const std::filesystem::path& csv);

}  // namespace cyclorama
