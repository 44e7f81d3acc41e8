// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/bench/calibration/chain_case.h"

namespace cyclorama {

/// Makes one scan and then draws pictures without a model (from the maps as they are), with each candidate model of the
/// wall, and, on the right wall, with each model of the projectors' lenses. Returns {"models": [one point of the trade
/// for each]}, or {"why": ...}.
nlohmann::ordered_json model_points(const ChainCase& chain, const std::filesystem::path& folder);

}  // namespace cyclorama
