// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/bench/calibration/chain_case.h"

namespace cyclorama {

/// One scan, and then pictures drawn by no model (the maps as they are), by each model of the wall's selection, and on the
/// right wall by each model of the projectors' lenses: {"models": [a point of the trade for each]}, or {"why": ...}.
nlohmann::ordered_json model_points(const ChainCase& chain, const std::filesystem::path& folder);

}  // namespace cyclorama
