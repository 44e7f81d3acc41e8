// SPDX-License-Identifier: Apache-2.0
#include "common/base/check.h"
#include "common/image/ktx2.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kLimitPx = std::size_t{1} << 18;
  const auto image = cyclorama::decode_ktx2(std::as_bytes(std::span(data, size)), kLimitPx);
  if (image) CHECK(!image->empty() && image->data().size() <= 4 * kLimitPx);
  return 0;
}
