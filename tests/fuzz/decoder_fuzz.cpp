// SPDX-License-Identifier: Apache-2.0
/// Arbitrary photographs: no decoded value is NaN or outside the projector.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "appliance/structured_light/decode_quality.h"
#include "appliance/structured_light/decoder.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  FuzzInput input(data, size);
  structured_light::PatternChoice choice{.width_px = 1 + static_cast<int>(input.byte() % 40),
                                         .height_px = 1 + static_cast<int>(input.byte() % 40)};
  choice.finest_bit = static_cast<int>(input.byte() % 3);
  choice.base_bit = static_cast<int>(input.byte() % 4) - 1;
  if (input.byte() % 2 == 1) {
    choice.phase_steps = 3 + static_cast<int>(input.byte() % 3);
    choice.phase_period_px = 4.0 + input.byte();
  }
  const auto set = structured_light::structured_light(choice);
  if (!set) return 0;
  const int width = 1 + static_cast<int>(input.byte() % 24);
  const int height = 1 + static_cast<int>(input.byte() % 24);
  structured_light::DecodeSettings settings;
  settings.min_patch_px = static_cast<int>(input.byte() % 8);
  settings.darkest = input.byte() / 255.0;
  auto decoder = structured_light::Decoder::from(*set, settings, width, height);
  if (!decoder) return 0;
  for (std::size_t i = 0; i < set->pictures.size(); ++i) {
    structured_light::Photo photo(width, height);
    for (float& light : photo.data()) light = static_cast<float>(input.byte()) / 255.0f;
    if (!decoder->add(photo)) std::abort();
  }
  const auto decoded = decoder->finish();
  if (!decoded) return 0;
  for (std::size_t i = 0; i < decoded->fate.data().size(); ++i) {
    for (std::size_t a = 0; a < 2; ++a) {
      const float position = decoded->position_px.data()[2 * i + a];
      if (!(position >= 0.0f && position <= static_cast<float>(a == 0 ? choice.width_px : choice.height_px)))
        std::abort();
      if (!(decoded->sigma_px.data()[2 * i + a] >= 0.0f)) std::abort();
    }
  }
  static_cast<void>(structured_light::quality_of(*decoded, 0.1));
  return 0;
}
