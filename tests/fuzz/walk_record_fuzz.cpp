// SPDX-License-Identifier: Apache-2.0
/// Any file is rejected with its line, or replayed without NaN.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "kiosk/tour/navigation/walk_record.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto record = cyclorama::tour::parse_walk_record({reinterpret_cast<const char*>(data), size}, "x");
  if (!record) {
    CHECK(!record.error().message().empty());
    return 0;
  }
  const cyclorama::tour::WalkReplay replay = cyclorama::tour::replayed(*record);
  CHECK(replay.peaks.finite);
  return 0;
}
