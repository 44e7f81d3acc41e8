// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "drivers/simulated/camera/simulation.h"

/// Any text is a simulation or an Error; a simulation's path is finite at any time.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto simulation = cyclorama::simulated::Simulation::parse(text, "fuzz.toml");
  if (!simulation) return 0;
  for (const double time_s : {-1e9, -1.0, 0.0, 0.5, 1.0, 7.3, 1e9}) {
    const auto pose = simulation->path.at(time_s);
    if (!pose.translation().allFinite() || !pose.rotation().coeffs().allFinite()) std::abort();
  }
  return 0;
}
