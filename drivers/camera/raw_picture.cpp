// SPDX-License-Identifier: Apache-2.0
#include "drivers/camera/raw_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

namespace cyclorama::camera {
namespace {

/// Upper bound on the size of a device's picture: 64 megapixels.
constexpr std::size_t kLimitPx = std::size_t{1} << 26;

/// Number of low bits of a sample that do not fit into 8 bits.
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

/// Reads rows with `step` bytes per pixel and brightness in byte `first` of each pixel.
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
      // Bits above the nominal ones come from a faulty driver; saturate, so that white stays white.
      out[x] = static_cast<std::uint8_t>(level > 255U ? 255U : level);
    }
  }
}

Status check_size(const RawPicture& raw) {
  if (raw.width <= 0 || raw.height <= 0 ||
      static_cast<std::size_t>(raw.width) > kLimitPx / static_cast<std::size_t>(raw.height)) {
    return Error(ErrorCode::kBadData, fmt::format("a picture of {}x{}", raw.width, raw.height));
  }
  return Done{};
}

Status check_jpeg(const RawPicture& raw, JpegDecoder* jpeg) {
  TRY_ASSIGN(const JpegSize size, jpeg->size_of(raw.bytes));
  if (size.width != raw.width || size.height != raw.height) {
    return Error(ErrorCode::kBadData,
                 fmt::format("a picture of {}x{} instead of {}x{}", size.width, size.height, raw.width, raw.height));
  }
  return Done{};
}

/// Checks that each of `rows` rows has at least `row` bytes; the last one may lack its padding.
Status check_rows(const RawPicture& raw, std::size_t row, std::size_t rows) {
  if (raw.row_bytes < row || raw.bytes.size() < row || (raw.bytes.size() - row) / raw.row_bytes < rows - 1) {
    return Error(ErrorCode::kBadData, fmt::format("{} bytes, too few for {}x{} in rows of {}", raw.bytes.size(),
                                                  raw.width, raw.height, raw.row_bytes));
  }
  return Done{};
}

std::uint8_t code_of(float value) { return static_cast<std::uint8_t>(std::clamp(value, 0.0f, 255.0f) + 0.5f); }

/// BT.601: Y = 0.299 R + 0.587 G + 0.114 B; U and V are the scaled differences B - Y and R - Y.
struct YuvToRgb {
  explicit YuvToRgb(bool is_full_range)
      : black(is_full_range ? 0.0f : 16.0f),
        of_brightness(is_full_range ? 1.0f : 255.0f / 219.0f),
        of_chroma(is_full_range ? 1.0f : 255.0f / 224.0f) {}
  void put(float y, float u, float v, std::uint8_t* ret_rgb) const {
    const float light = of_brightness * (y - black);
    const float red = 2.0f * (1.0f - 0.299f) * of_chroma * (v - 128.0f);
    const float blue = 2.0f * (1.0f - 0.114f) * of_chroma * (u - 128.0f);
    ret_rgb[0] = code_of(light + red);
    ret_rgb[1] = code_of(light - (0.299f * red + 0.114f * blue) / 0.587f);
    ret_rgb[2] = code_of(light + blue);
  }
  float black;
  float of_brightness;
  float of_chroma;
};

/// Start and stride of a row's brightness and chroma, for the first of a pair of pixels.
struct YuvRow {
  const std::byte* brightness = nullptr;
  const std::byte* chroma = nullptr;  ///< Alternating U and V.
  std::size_t brightness_step = 1;
  std::size_t chroma_step = 1;  ///< Distance between U and V in bytes.
};

void take_colours(const RawPicture& raw, RgbImage* ret_colour) {
  const YuvToRgb convert(raw.colour.is_full_range);
  const std::size_t height = static_cast<std::size_t>(raw.height);
  for (std::size_t y = 0; y < height; ++y) {
    const std::byte* const row = raw.bytes.data() + y * raw.row_bytes;
    YuvRow at{row, raw.bytes.data() + (height + y / 2) * raw.row_bytes, 1, 1};
    if (raw.colour.chroma == Chroma::kBetween) {
      const bool is_chroma_first = raw.layout == PixelLayout::kUyvy;
      at = {row + (is_chroma_first ? 1 : 0), row + (is_chroma_first ? 0 : 1), 2, 2};
    }
    std::uint8_t* const out = ret_colour->at(0, static_cast<int>(y));
    for (std::size_t x = 0; x < static_cast<std::size_t>(raw.width); ++x) {
      const std::size_t pair = 2 * (x / 2);
      const auto first = static_cast<float>(at.chroma[pair * at.chroma_step]);
      const auto second = static_cast<float>(at.chroma[(pair + 1) * at.chroma_step]);
      const auto light = static_cast<float>(at.brightness[x * at.brightness_step]);
      convert.put(light, raw.colour.is_v_first ? second : first, raw.colour.is_v_first ? first : second, out + 3 * x);
    }
  }
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
  TRY(check_size(raw));
  if (raw.layout == PixelLayout::kJpeg) {
    TRY(check_jpeg(raw, jpeg));
    TRY_ASSIGN(*ret_grey, jpeg->decode_grey(raw.bytes, kLimitPx));
    return Done{};
  }
  const auto width = static_cast<std::size_t>(raw.width);
  TRY(check_rows(raw, width * bytes_per_pixel(raw.layout), static_cast<std::size_t>(raw.height)));
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

Status to_colour(const RawPicture& raw, JpegDecoder* jpeg, RgbImage* ret_colour) {
  CHECK(raw.colour.chroma != Chroma::kNone);
  TRY(check_size(raw));
  if (raw.colour.chroma == Chroma::kInJpeg) {
    TRY(check_jpeg(raw, jpeg));
    TRY_ASSIGN(*ret_colour, jpeg->decode(raw.bytes, kLimitPx));
    return Done{};
  }
  // The last pixel of an odd row shares its chroma with a missing one.
  const auto even_width = static_cast<std::size_t>(raw.width + 1) / 2 * 2;
  const auto height = static_cast<std::size_t>(raw.height);
  const bool has_plane = raw.colour.chroma == Chroma::kPairs;
  TRY(check_rows(raw, even_width * bytes_per_pixel(raw.layout), has_plane ? height + (height + 1) / 2 : height));
  if (ret_colour->width() != raw.width || ret_colour->height() != raw.height) {
    *ret_colour = RgbImage(raw.width, raw.height);
  }
  take_colours(raw, ret_colour);
  return Done{};
}

}  // namespace cyclorama::camera
