// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "tests/bench/calibration/chain_case.h"

namespace cyclorama {

/// Explains the causes of steps at seams and of errors of weights: compares the same wall with the measurements; with
/// the truth in place of the maps, of the light, and of both; and with other slopes. `folder` holds the case's
/// calibration, as kept by run_chain(). Prints a table, and writes a CSV of all borders to `csv` unless that is empty.
/// Returns an exit code.
int explain_seams(const ChainCase& chain, const std::filesystem::path& folder, const std::filesystem::path& csv);

}  // namespace cyclorama
