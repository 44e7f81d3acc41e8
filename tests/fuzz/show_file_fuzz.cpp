// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "appliance/calibration/show_file.h"
#include "common/base/check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  const auto show = calibration::parse_show({reinterpret_cast<const char*>(data), size}, "fuzz");
  if (!show) {
    CHECK(show.error().code() == ErrorCode::kBadData && !show.error().message().empty());
    return 0;
  }
  // An accepted file can be written and read again.
  const auto back = calibration::parse_show(calibration::show_json(*show), "fuzz");
  CHECK(back.has_value() && back->projectors.size() == show->projectors.size());
  return 0;
}
