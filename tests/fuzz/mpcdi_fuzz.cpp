// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>
#include <span>

#include "appliance/interchange/mpcdi.h"
#include "common/base/check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  const interchange::WarpLimits limits{.map_px = 1 << 16, .total_bytes = 1 << 22, .file_bytes = 1 << 22, .regions = 8};
  const auto file = interchange::decode_mpcdi(std::as_bytes(std::span(data, size)), limits);
  if (!file) return 0;
  const auto written = interchange::encode_mpcdi(file->set);  // An accepted file is unchanged by a round trip.
  CHECK(written.has_value());
  const auto back = interchange::decode_mpcdi(*written);
  CHECK(back.has_value() && back->set == file->set);
  return 0;
}
