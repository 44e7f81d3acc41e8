// SPDX-License-Identifier: Apache-2.0
/// The extent of a request stays the same when more bytes follow it, and lies within the limits.
#include <cstddef>
#include <cstdint>
#include <string>

#include "common/base/check.h"
#include "common/http/request_extent.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;  // NOLINT(google-build-using-namespace)
  constexpr std::size_t kHead = 1024;
  constexpr std::size_t kBody = 64;
  const std::string text(reinterpret_cast<const char*>(data), size);
  const RequestExtent extent = request_extent(text, kHead, kBody);
  CHECK(extent.bytes <= kHead + kBody);
  if (extent.bytes == 0) return 0;
  const RequestExtent with_more = request_extent(text + "GET / HTTP/1.1\r\n\r\n", kHead, kBody);
  CHECK(with_more.bytes == extent.bytes && with_more.is_body_left_out == extent.is_body_left_out);
  return 0;
}
