// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

namespace cyclorama {

/// Each prints a table and returns the figures that its benchmark closes with.
nlohmann::json measure_pose(int frames, int threads);
nlohmann::json measure_real();
nlohmann::json measure_speed(int pictures);
nlohmann::json measure_trade(bool quick);
nlohmann::json measure_extremes(bool quick);

}  // namespace cyclorama
