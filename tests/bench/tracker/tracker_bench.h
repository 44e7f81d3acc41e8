// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace cyclorama {

/// Each function prints a table and returns the figures that its benchmark reports.
/// `keep` is a file to which measurements are written as they come; another run with the same `frames` continues it.
/// Stops after `seconds`, with figures of the measurements so far.
nlohmann::json measure_pose(int frames, int threads, const std::string& keep, double seconds);
nlohmann::json measure_real();
nlohmann::json measure_speed(int pictures);
/// `only` is one parameter of "filter", "decimation", "size", "fold"; empty: all. `scenes` is the number for each
/// value; 0: the default.
nlohmann::json measure_trade(bool quick, const std::string& only, int scenes);
nlohmann::json measure_extremes(bool quick);

}  // namespace cyclorama
