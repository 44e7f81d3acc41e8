// SPDX-License-Identifier: Apache-2.0
/// farm.toml.
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "common/base/check.h"
#include "renderfarm/coordinator/coordinator_config.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  const auto options = coordinator::parse_coordinator_config({reinterpret_cast<const char*>(data), size}, "farm.toml");
  if (!options) {
    CHECK(options.error().message().find("farm.toml") != std::string::npos);
    return 0;
  }
  CHECK(validate(*options));
  CHECK(!options->scenes.empty() && options->limits.nodes > 0 && options->limits.sessions > 0);
  CHECK(options->limits.picture_px >= 10'000 && options->limits.picture_px <= 269'000'000);
  const double rate = options->distribution.files.bytes_per_second;
  CHECK(std::isfinite(rate) && rate >= 0.0 && options->distribution.files.streams > 0);
  return 0;
}
