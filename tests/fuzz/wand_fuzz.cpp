// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "common/wand/wand.h"

/// Any text is a wand or an Error; a wand has finite faces and survives a round trip.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto wand = cyclorama::parse_wand(text, "fuzz.toml");
  if (!wand) return 0;
  if (wand->tags.empty() || wand->tags.size() > 32) std::abort();
  for (const cyclorama::WandTag& tag : wand->tags) {
    const auto face = cyclorama::face_of(tag);
    if (!face.rotation().coeffs().allFinite() || !face.translation().allFinite()) std::abort();
  }
  // A micrometre may decide whether a quadrangle is a square; the text itself must be valid.
  const auto again = cyclorama::parse_wand(cyclorama::wand_toml(*wand), "again.toml");
  if (again && again->tags.size() != wand->tags.size()) std::abort();
  return 0;
}
