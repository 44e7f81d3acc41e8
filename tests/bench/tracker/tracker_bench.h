// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace cyclorama {

/// Each prints a table and returns the figures that its benchmark closes with.
/// `keep`: a file that what is measured goes to as it comes; another run with the same `frames` goes on where it ends.
/// Stops after `seconds`; the figures are those of what is there.
nlohmann::json measure_pose(int frames, int threads, const std::string& keep, double seconds);
nlohmann::json measure_real();
nlohmann::json measure_speed(int pictures);
/// `only`: one knob of "filter", "decimation", "size", "fold"; empty: all. `scenes`: for each value; 0: the usual.
nlohmann::json measure_trade(bool quick, const std::string& only, int scenes);
nlohmann::json measure_extremes(bool quick);

}  // namespace cyclorama
