// SPDX-License-Identifier: Apache-2.0
#include "drivers/camera/raw_picture.h"

#include <fmt/format.h>

#include <cstring>

namespace cyclorama {
namespace {

/// The largest picture that a device may hand over: 64 megapixels.
constexpr std::size_t kLimitPx = std::size_t{1} << 26;

/// The low bits of a sample that 8 bits have no room for.
int surplus_bits(PixelLayout layout) {
  switch (layout) {
    case PixelLayout::kGrey16:
      return 8;
    case PixelLayout::kGrey12:
      return 4;
    case PixelLayout::kGrey10:
      return 2;
    default:
      return 0;
  }
}

/// Rows of `step` bytes per pixel, brightness in byte `first` of each.
void take_every(std::size_t step, std::size_t first, const RawPicture& raw, GreyImage* ret_grey) {
  for (int y = 0; y < raw.height; ++y) {
    const std::byte* const row = raw.bytes.data() + static_cast<std::size_t>(y) * raw.row_bytes + first;
    std::uint8_t* const out = ret_grey->at(0, y);
    const auto width = static_cast<std::size_t>(raw.width);
    for (std::size_t x = 0; x < width; ++x) out[x] = static_cast<std::uint8_t>(row[x * step]);
  }
}

void take_deep(const RawPicture& raw, GreyImage* ret_grey) {
  const int surplus = surplus_bits(raw.layout);
  for (int y = 0; y < raw.height; ++y) {
    const std::byte* const row = raw.bytes.data() + static_cast<std::size_t>(y) * raw.row_bytes;
    std::uint8_t* const out = ret_grey->at(0, y);
    for (int x = 0; x < raw.width; ++x) {
      const auto at = 2 * static_cast<std::size_t>(x);
      const unsigned value = static_cast<unsigned>(row[at]) | static_cast<unsigned>(row[at + 1]) << 8U;
      const unsigned level = value >> static_cast<unsigned>(surplus);
      // Bits above the promised ones are noise of a broken driver; white stays white.
      out[x] = static_cast<std::uint8_t>(level > 255U ? 255U : level);
    }
  }
}

Status decode(const RawPicture& raw, JpegDecoder* jpeg, GreyImage* ret_grey) {
  TRY_ASSIGN(const JpegSize size, jpeg->size_of(raw.bytes));
  if (size.width != raw.width || size.height != raw.height) {
    return Error(ErrorCode::kBadData,
                 fmt::format("a picture of {}x{} instead of {}x{}", size.width, size.height, raw.width, raw.height));
  }
  TRY_ASSIGN(*ret_grey, jpeg->decode_grey(raw.bytes, kLimitPx));
  return Done{};
}

}  // namespace

std::string_view name_of(PixelLayout layout) {
  switch (layout) {
    case PixelLayout::kGrey8:
      return "grey";
    case PixelLayout::kPlanarYuv:
      return "planar YUV";
    case PixelLayout::kGrey16:
      return "grey, 16 bits";
    case PixelLayout::kGrey12:
      return "grey, 12 bits";
    case PixelLayout::kGrey10:
      return "grey, 10 bits";
    case PixelLayout::kYuyv:
    case PixelLayout::kUyvy:
      return "YUV 4:2:2";
    case PixelLayout::kJpeg:
      return "JPEG";
  }
  return "";
}

std::size_t bytes_per_pixel(PixelLayout layout) {
  if (layout == PixelLayout::kJpeg) return 0;
  return layout == PixelLayout::kGrey8 || layout == PixelLayout::kPlanarYuv ? 1 : 2;
}

Status to_grey(const RawPicture& raw, JpegDecoder* jpeg, GreyImage* ret_grey) {
  const auto width = static_cast<std::size_t>(raw.width);
  const auto height = static_cast<std::size_t>(raw.height);
  if (raw.width <= 0 || raw.height <= 0 || width > kLimitPx / height) {
    return Error(ErrorCode::kBadData, fmt::format("a picture of {}x{}", raw.width, raw.height));
  }
  if (raw.layout == PixelLayout::kJpeg) return decode(raw, jpeg, ret_grey);
  const std::size_t row = width * bytes_per_pixel(raw.layout);
  // The last row may lack its padding.
  if (raw.row_bytes < row || raw.bytes.size() < row || (raw.bytes.size() - row) / raw.row_bytes < height - 1) {
    return Error(ErrorCode::kBadData, fmt::format("{} bytes, too few for {}x{} in rows of {}", raw.bytes.size(),
                                                  raw.width, raw.height, raw.row_bytes));
  }
  if (ret_grey->width() != raw.width || ret_grey->height() != raw.height) *ret_grey = GreyImage(raw.width, raw.height);
  switch (raw.layout) {
    case PixelLayout::kGrey8:
    case PixelLayout::kPlanarYuv:
      for (int y = 0; y < raw.height; ++y) {
        std::memcpy(ret_grey->at(0, y), raw.bytes.data() + static_cast<std::size_t>(y) * raw.row_bytes, width);
      }
      break;
    case PixelLayout::kYuyv:
      take_every(2, 0, raw, ret_grey);
      break;
    case PixelLayout::kUyvy:
      take_every(2, 1, raw, ret_grey);
      break;
    default:
      take_deep(raw, ret_grey);
  }
  return Done{};
}

}  // namespace cyclorama
