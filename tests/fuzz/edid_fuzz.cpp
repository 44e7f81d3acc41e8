// SPDX-License-Identifier: Apache-2.0
/// Arbitrary EDID bytes.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <numeric>
#include <vector>

#include "common/edid/edid.h"
#include "drivers/output/drm/mode_choice.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  std::vector<std::uint8_t> bytes(data, data + size);
  static_cast<void>(parse_edid(bytes));
  if (size < 128) return 0;
  // The same bytes with a valid header, and valid checksums of all blocks.
  for (std::size_t i = 0; i < 8; ++i) bytes[i] = i == 0 || i == 7 ? 0x00 : 0xff;
  for (auto block = bytes.begin(); bytes.end() - block >= 128; block += 128) {
    block[127] = 0;
    block[127] = static_cast<std::uint8_t>(256 - std::accumulate(block, block + 128, 0) % 256);
  }
  const auto edid = parse_edid(bytes);
  if (!edid) std::abort();
  for (const char c : edid->text()) {
    if (c < 0x20 || c > 0x7e) std::abort();
  }
  if (edid->timings.size() > 128) std::abort();
  for (const VideoTiming& timing : edid->timings) {
    if (!timing.is_possible()) std::abort();
  }
  const auto modes = output::modes_to_try(output::modes_of(edid->timings), {1920, 1080, 60.0});
  if (modes.empty() || modes.size() > 32) std::abort();
  return 0;
}
