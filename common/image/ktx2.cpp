// SPDX-License-Identifier: Apache-2.0
#include "common/image/ktx2.h"

#include <fmt/format.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>
#include <vector>

#include "common/image/etc1s.h"
#include "common/image/uastc.h"

namespace cyclorama {
namespace {

constexpr std::string_view kMagic = "\xabKTX 20\xbb\r\n\x1a\n";

// Offsets of the header's fields. Source: KTX 2.0, section 3.
constexpr std::size_t kVkFormat = 12;
constexpr std::size_t kWidth = 20;
constexpr std::size_t kHeight = 24;
constexpr std::size_t kDepth = 28;
constexpr std::size_t kLayers = 32;
constexpr std::size_t kFaces = 36;
constexpr std::size_t kLevelCount = 40;
constexpr std::size_t kScheme = 44;
constexpr std::size_t kDescription = 48;
constexpr std::size_t kDescriptionBytes = 52;
constexpr std::size_t kGlobalData = 64;
constexpr std::size_t kGlobalDataBytes = 72;
constexpr std::size_t kLevels = 80;
constexpr std::size_t kFirstLevelEnd = 104;

constexpr std::size_t kColourModel = 12;  ///< In the data format description.
enum ColourModel : std::uint32_t { kEtc1s = 163, kUastc = 166 };
enum Scheme : std::uint32_t { kPlain = 0, kBasisLz = 1, kZstandard = 2 };

using Bytes = std::span<const std::byte>;

Error damaged(std::string_view what) {
  return Error(ErrorCode::kBadData, fmt::format("the KTX2 texture {}; copy or export it again", what));
}
Error unsupported(std::string_view what) {
  return Error(ErrorCode::kBadData,
               fmt::format("the KTX2 texture {}; export it as a flat Basis Universal texture, PNG or JPEG", what));
}

/// Returns a little-endian integer. Precondition: it lies within `bytes`.
template <typename T>
T number_at(Bytes bytes, std::size_t offset) {
  T value{};
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

/// Returns `size` bytes from `offset` on. Errors: kBadData if the file ends before their end.
Result<Bytes> part_of(Bytes bytes, std::uint64_t offset, std::uint64_t size) {
  if (offset > bytes.size() || size > bytes.size() - offset) return damaged("ends too early");
  return bytes.subspan(offset, size);
}

struct Size {
  int width = 0;
  int height = 0;
};

Result<Size> size_of(Bytes file, std::size_t limit_px) {
  const auto width = number_at<std::uint32_t>(file, kWidth);
  const auto height = number_at<std::uint32_t>(file, kHeight);
  constexpr std::uint32_t kMaxSide = 1u << 20;
  if (width == 0 || height == 0 || width > kMaxSide || height > kMaxSide) {
    return damaged(fmt::format("has {}x{} pixels", width, height));
  }
  if (std::uint64_t{width} * height > limit_px) {
    return Error(ErrorCode::kBadData, fmt::format("the KTX2 has {}x{} pixels; at most {} pixels are accepted here",
                                                  width, height, limit_px));
  }
  if (number_at<std::uint32_t>(file, kDepth) > 1) return unsupported("is a volume");
  if (number_at<std::uint32_t>(file, kLayers) > 1) return unsupported("is an array of pictures");
  if (number_at<std::uint32_t>(file, kFaces) != 1) return unsupported("is a cube map");
  return Size{static_cast<int>(width), static_cast<int>(height)};
}

Result<RgbaImage> decode_etc1s(Bytes file, Bytes level, Size size) {
  TRY_ASSIGN(const Bytes global, part_of(file, number_at<std::uint64_t>(file, kGlobalData),
                                         number_at<std::uint64_t>(file, kGlobalDataBytes)));
  constexpr std::size_t kHeaderBytes = 20;
  constexpr std::size_t kImageBytes = 20;
  const std::size_t levels = std::max(1u, number_at<std::uint32_t>(file, kLevelCount));
  if (levels > 32 || global.size() < kHeaderBytes + levels * kImageBytes) return damaged("ends too early");
  Etc1sSource source;
  source.endpoint_count = number_at<std::uint16_t>(global, 0);
  source.selector_count = number_at<std::uint16_t>(global, 2);
  std::uint64_t at = kHeaderBytes + levels * kImageBytes;
  std::size_t field = 4;
  for (Bytes* const part : {&source.endpoints, &source.selectors, &source.tables}) {
    const auto bytes = number_at<std::uint32_t>(global, field);
    TRY_ASSIGN(*part, part_of(global, at, bytes));
    at += bytes;
    field += 4;
  }
  TRY_ASSIGN(const Etc1sCodebook codebook, Etc1sCodebook::read(source));
  constexpr std::uint32_t kIsDifference = 2;
  if ((number_at<std::uint32_t>(global, kHeaderBytes) & kIsDifference) != 0) return unsupported("is part of a video");
  const auto slice = [&](std::size_t offset) {
    return part_of(level, number_at<std::uint32_t>(global, kHeaderBytes + offset),
                   number_at<std::uint32_t>(global, kHeaderBytes + offset + 4));
  };
  TRY_ASSIGN(const Bytes colour, slice(4));
  TRY_ASSIGN(const Bytes alpha, slice(12));
  RgbaImage image(size.width, size.height, 255);
  TRY(codebook.decode(colour, Etc1sCodebook::Target::kColour, &image));
  if (!alpha.empty()) TRY(codebook.decode(alpha, Etc1sCodebook::Target::kAlpha, &image));
  return image;
}

Result<RgbaImage> decode_uastc_blocks(Bytes blocks, Size size) {
  const int columns = (size.width + 3) / 4;
  const int rows = (size.height + 3) / 4;
  if (blocks.size() != static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows) * kUastcBlockBytes) {
    return damaged("has more or fewer blocks than its size needs");
  }
  RgbaImage image(size.width, size.height);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column, blocks = blocks.subspan(kUastcBlockBytes)) {
      const std::optional<UastcPixels> pixels = decode_uastc(blocks.first(kUastcBlockBytes));
      if (!pixels) return damaged(fmt::format("has a damaged block at ({}, {})", 4 * column, 4 * row));
      for (int i = 0; i < 16; ++i) {
        const int x = 4 * column + i % 4;
        const int y = 4 * row + i / 4;
        const std::array<std::uint8_t, 4>& pixel = (*pixels)[static_cast<std::size_t>(i)];
        if (x < size.width && y < size.height) std::copy(pixel.begin(), pixel.end(), image.at(x, y));
      }
    }
  }
  return image;
}

Result<RgbaImage> decode_zstandard(Bytes level, std::uint64_t raw_bytes, Size size) {
  const std::uint64_t blocks = std::uint64_t(size.width + 3) / 4 * (std::uint64_t(size.height + 3) / 4);
  if (raw_bytes != blocks * kUastcBlockBytes) return damaged("has more or fewer blocks than its size needs");
  std::vector<std::byte> raw(raw_bytes);
  if (ZSTD_decompress(raw.data(), raw.size(), level.data(), level.size()) != raw.size()) {
    return damaged("is no valid Zstandard stream");
  }
  return decode_uastc_blocks(raw, size);
}

}  // namespace

bool is_ktx2(std::span<const std::byte> bytes) {
  return bytes.size() >= kMagic.size() && std::memcmp(bytes.data(), kMagic.data(), kMagic.size()) == 0;
}

Result<RgbaImage> decode_ktx2(std::span<const std::byte> ktx2, std::size_t limit_px) {
  if (!is_ktx2(ktx2) || ktx2.size() < kFirstLevelEnd) return damaged("ends too early");
  TRY_ASSIGN(const Size size, size_of(ktx2, limit_px));
  TRY_ASSIGN(const Bytes description, part_of(ktx2, number_at<std::uint32_t>(ktx2, kDescription),
                                              number_at<std::uint32_t>(ktx2, kDescriptionBytes)));
  if (description.size() <= kColourModel) return damaged("has no data format");
  TRY_ASSIGN(const Bytes level,
             part_of(ktx2, number_at<std::uint64_t>(ktx2, kLevels), number_at<std::uint64_t>(ktx2, kLevels + 8)));
  const auto model = number_at<std::uint8_t>(description, kColourModel);
  const auto scheme = number_at<std::uint32_t>(ktx2, kScheme);
  if (number_at<std::uint32_t>(ktx2, kVkFormat) == 0) {
    if (model == kEtc1s && scheme == kBasisLz) return decode_etc1s(ktx2, level, size);
    if (model == kUastc && scheme == kPlain) return decode_uastc_blocks(level, size);
    if (model == kUastc && scheme == kZstandard) {
      return decode_zstandard(level, number_at<std::uint64_t>(ktx2, kLevels + 16), size);
    }
  }
  return unsupported(fmt::format("is of Vulkan's format {}, colour model {} and compression {}",
                                 number_at<std::uint32_t>(ktx2, kVkFormat), model, scheme));
}

}  // namespace cyclorama
