// SPDX-License-Identifier: Apache-2.0
/// Photographs of a real board under Gray code (shared/data/graycode), their pattern set, and a decoder for them.
#pragma once

#include <filesystem>
#include <string>

#include "appliance/structured_light/decoder.h"
#include "appliance/structured_light/pattern_set.h"
#include "common/base/result.h"
#include "common/image/image_file.h"

namespace cyclorama {

/// Columns, rows, white, black, as in "order" of expected.json.
inline structured_light::PatternSet real_pattern_set() {
  structured_light::PatternSet set;
  set.width_px = 1024;
  set.height_px = 768;
  for (const structured_light::PatternAxis axis :
       {structured_light::PatternAxis::kColumns, structured_light::PatternAxis::kRows}) {
    for (int bit = 9; bit >= 0; --bit) {
      set.pictures.push_back({.kind = structured_light::PatternKind::kBit, .axis = axis, .bit = bit});
      set.pictures.push_back(
          {.kind = structured_light::PatternKind::kBit, .axis = axis, .bit = bit, .is_inverse = true});
    }
  }
  set.pictures.push_back({.kind = structured_light::PatternKind::kWhite});
  set.pictures.push_back({.kind = structured_light::PatternKind::kBlack, .level = 0.0});
  return set;
}

inline constexpr int kRealCaptures = 3;
inline constexpr int kRealWhite = 40;

inline Result<GreyImage> real_photo(const std::filesystem::path& folder, int capture, int number) {
  const std::string name = (number < 10 ? "graycode_0" : "graycode_") + std::to_string(number) + ".jpg";
  return read_grey_image(folder / ("capture_" + std::to_string(capture)) / name, kPhotoLimitPx);
}

/// Returns a decoder that has received all photographs of a capture.
inline Result<structured_light::Decoder> real_decoder(const std::filesystem::path& folder, int capture,
                                                      const structured_light::DecodeSettings& settings = {}) {
  const structured_light::PatternSet set = real_pattern_set();
  TRY_ASSIGN(const GreyImage first, real_photo(folder, capture, 0));
  TRY_ASSIGN(structured_light::Decoder decoder,
             structured_light::Decoder::from(set, settings, first.width(), first.height()));
  for (int i = 0; i < static_cast<int>(set.pictures.size()); ++i) {
    TRY_ASSIGN(const GreyImage photo, real_photo(folder, capture, i));
    TRY(decoder.add(structured_light::photo_of(photo)));
  }
  return decoder;
}

}  // namespace cyclorama
