// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

#include "common/base/check.h"
#include "common/image/inverse_depth.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  constexpr std::uint16_t kUntouched = 777;
  FuzzInput input(data, size);
  const int width = 1 + static_cast<int>(input.byte() % 64);
  const int height = 1 + static_cast<int>(input.byte() % 64);
  // Encoded depth, damaged in one place, or the rest of the input as it is.
  std::string bytes;
  if (input.byte() % 2 == 0) {
    InverseDepthImage depth(width, height);
    for (std::uint16_t& value : depth.data()) {
      value = static_cast<std::uint16_t>((input.byte() << 8 | input.byte()) % (kMaxInverseDepth + 200));
    }
    bytes = encode_inverse_depth(depth);
    const std::size_t at = (input.byte() << 8 | input.byte()) % bytes.size();
    bytes[at] = static_cast<char>(bytes[at] ^ static_cast<char>(input.byte()));
  } else {
    const auto rest = input.bytes(size);
    bytes.assign(rest.begin(), rest.end());
  }
  const InverseDepthImage before(width + 3, height + 2, kUntouched);
  const PixelRect cells{3, 1, width, height};
  InverseDepthImage decoded = before;
  const Status status = decode_inverse_depth(std::as_bytes(std::span(bytes)), cells, &decoded);
  if (!status) {
    CHECK(status.error().code() == ErrorCode::kBadData && decoded == before);
    return 0;
  }
  InverseDepthImage part(width, height);
  for (int y = 0; y < decoded.height(); ++y) {
    for (int x = 0; x < decoded.width(); ++x) {
      const bool inside = x >= cells.x && y >= cells.y && y < cells.y + height;
      CHECK(inside ? *decoded.at(x, y) <= kMaxInverseDepth : *decoded.at(x, y) == kUntouched);
      if (inside) *part.at(x - cells.x, y - cells.y) = *decoded.at(x, y);
    }
  }
  InverseDepthImage again(width, height);
  const std::string encoded = encode_inverse_depth(part);
  CHECK(decode_inverse_depth(std::as_bytes(std::span(encoded)), {0, 0, width, height}, &again).has_value());
  CHECK(again == part);
  return 0;
}
