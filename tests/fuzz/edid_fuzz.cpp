// SPDX-License-Identifier: Apache-2.0
/// Arbitrary EDID bytes.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <numeric>
#include <vector>

#include "drivers/output/drm/edid.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  std::vector<std::uint8_t> bytes(data, data + size);
  static_cast<void>(output::parse_edid(bytes));
  if (size < 128) return 0;
  // The same bytes with a valid header and checksum.
  for (std::size_t i = 0; i < 8; ++i) bytes[i] = i == 0 || i == 7 ? 0x00 : 0xff;
  bytes[127] = 0;
  bytes[127] = static_cast<std::uint8_t>(256 - std::accumulate(bytes.begin(), bytes.begin() + 128, 0) % 256);
  const auto edid = output::parse_edid(bytes);
  if (!edid) std::abort();
  for (const char c : edid->text()) {
    if (c < 0x20 || c > 0x7e) std::abort();
  }
  return 0;
}
