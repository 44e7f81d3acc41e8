// SPDX-License-Identifier: Apache-2.0
/// Kept pictures and visits, also behind a right checksum.
#include <cstddef>
#include <cstdint>
#include <string>

#include "common/base/check.h"
#include "kiosk/tour/session/kept_picture.h"

using namespace cyclorama::tour;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string bytes(reinterpret_cast<const char*>(data), size);
  static_cast<void>(parse_kept_picture(bytes));
  bytes = "cyclorama-kept 1\n" + bytes;
  const std::uint64_t sum = checksum_of(bytes);
  for (int shift = 0; shift < 64; shift += 8) bytes.push_back(static_cast<char>((sum >> shift) & 0xff));
  if (const auto picture = parse_kept_picture(bytes)) CHECK(picture->end.tiles() == picture->tiles.size());
  static_cast<void>(parse_kept_visit(bytes));
  return 0;
}
