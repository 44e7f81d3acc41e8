// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <cstdlib>
#include <span>

#include "drivers/camera/raw_picture.h"

/// Any bytes in any layout yield a picture of the requested size, or an Error.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  if (size < 6) return 0;
  camera::RawPicture raw;
  raw.layout = static_cast<camera::PixelLayout>(data[0] % (static_cast<int>(camera::PixelLayout::kJpeg) + 1));
  raw.width = static_cast<std::int8_t>(data[1]) * 4;
  raw.height = static_cast<std::int8_t>(data[2]) * 4;
  raw.row_bytes = static_cast<std::size_t>(data[3]) << (data[4] % 60U);
  raw.bytes = std::as_bytes(std::span(data + 5, size - 5));
  JpegDecoder jpeg;
  GreyImage grey;
  const auto done = camera::to_grey(raw, &jpeg, &grey);
  if (done && (grey.width() != raw.width || grey.height() != raw.height)) std::abort();
  raw.colour = {static_cast<camera::Chroma>(1 + data[0] / 16 % 3), data[0] >= 128, data[4] >= 128};
  const bool is_packed = raw.layout == camera::PixelLayout::kYuyv || raw.layout == camera::PixelLayout::kUyvy;
  const bool has_chroma = raw.colour.chroma == camera::Chroma::kBetween ? is_packed
                          : raw.colour.chroma == camera::Chroma::kPairs ? raw.layout == camera::PixelLayout::kPlanarYuv
                                                                        : raw.layout == camera::PixelLayout::kJpeg;
  if (!has_chroma) return 0;
  RgbImage rgb;
  const auto read = camera::to_colour(raw, &jpeg, &rgb);
  if (read && (rgb.width() != raw.width || rgb.height() != raw.height)) std::abort();
  return 0;
}
