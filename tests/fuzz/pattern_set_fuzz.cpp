// SPDX-License-Identifier: Apache-2.0
/// A record of the patterns that photographs show.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "appliance/structured_light/decoder.h"
#include "appliance/structured_light/pattern_drawing.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  const auto set = structured_light::read_pattern_set(std::string(data, data + size));
  if (!set) return 0;
  // An accepted set is unchanged by a round trip, can be drawn, and is decoded or rejected.
  const auto again = structured_light::read_pattern_set(structured_light::to_text(*set));
  if (!again || !(*again == *set)) std::abort();
  for (const structured_light::PatternPicture& picture : set->pictures) {
    const double level = structured_light::level_at(*set, picture, set->width_px - 1, set->height_px - 1);
    if (!(level >= 0.0 && level <= 1.0)) std::abort();
  }
  static_cast<void>(structured_light::Decoder::from(*set, {}, 4, 3));
  return 0;
}
