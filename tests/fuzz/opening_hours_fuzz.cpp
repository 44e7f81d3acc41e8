// SPDX-License-Identifier: Apache-2.0
/// A line of [hours] and a time: accepted hours have an answer at any time.
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "common/opening/opening_hours.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::int32_t second = 0;
  if (size < sizeof second) return 0;
  std::memcpy(&second, data, sizeof second);
  const std::string line(reinterpret_cast<const char*>(data) + sizeof second, size - sizeof second);
  const auto hours = cyclorama::OpeningHours::parse({line}, "UTC");
  if (hours) static_cast<void>(hours->is_open(cyclorama::WallTime(std::chrono::seconds(second))));
  return 0;
}
