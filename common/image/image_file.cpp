// SPDX-License-Identifier: Apache-2.0
#include "common/image/image_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "common/base/file.h"
#include "common/image/foreign_jpeg.h"
#include "common/image/jpeg.h"
#include "common/image/ktx2.h"
#include "common/image/png.h"
#include "common/image/webp.h"

namespace cyclorama {
namespace {

constexpr std::string_view kJpegMagic = "\xff\xd8";
constexpr std::size_t kFileLimitBytes = std::size_t{512} << 20;

bool begins_with(std::span<const std::byte> bytes, std::string_view magic, std::size_t offset = 0) {
  if (bytes.size() < offset + magic.size()) return false;
  return std::equal(magic.begin(), magic.end(), bytes.begin() + static_cast<std::ptrdiff_t>(offset),
                    [](char a, std::byte b) { return static_cast<std::byte>(a) == b; });
}

Error unsupported(std::span<const std::byte> bytes) {
  const char* name = "neither PNG, JPEG, WebP nor KTX2";
  if (bytes.empty()) name = "an empty file";
  if (begins_with(bytes, "\x76\x2f\x31\x01")) name = "an OpenEXR picture";
  if (begins_with(bytes, "#?RADIANCE") || begins_with(bytes, "#?RGBE")) name = "a Radiance HDR picture";
  if (begins_with(bytes, "\xabKTX")) name = "a KTX 1 texture";
  if (begins_with(bytes, "GIF8")) name = "a GIF picture";
  return Error(ErrorCode::kBadData, fmt::format("this is {}; convert it to PNG or JPEG", name));
}

Result<GreyImage> grey_of(std::span<const std::byte> bytes, std::size_t limit_px) {
  TRY_ASSIGN(const RgbaImage rgba, decode_image(bytes, limit_px));
  GreyImage grey(rgba.width(), rgba.height());
  for (std::size_t i = 0; i < grey.data().size(); ++i) {
    const auto px = rgba.data().subspan(4 * i, 4);
    grey.data()[i] = static_cast<std::uint8_t>((299 * px[0] + 587 * px[1] + 114 * px[2] + 500) / 1000);
  }
  return grey;
}

}  // namespace

Result<RgbaImage> decode_image(std::span<const std::byte> bytes, std::size_t limit_px) {
  if (begins_with(bytes, "\x89PNG")) return decode_png(bytes, limit_px);
  if (begins_with(bytes, "RIFF") && begins_with(bytes, "WEBP", 8)) return decode_webp(bytes, limit_px);
  if (is_ktx2(bytes)) return decode_ktx2(bytes, limit_px);
  if (!begins_with(bytes, kJpegMagic)) return unsupported(bytes);
  return decode_foreign_jpeg(bytes, limit_px);
}

Result<RgbaImage> read_image(const std::filesystem::path& path, std::size_t limit_px) {
  TRY_ASSIGN(const std::vector<std::byte> bytes, read_file(path, kFileLimitBytes));
  auto image = decode_image(bytes, limit_px);
  if (!image) return std::move(image).error().while_doing(fmt::format("reading picture '{}'", path.string()));
  return image;
}

Result<GreyImage> read_grey_image(const std::filesystem::path& path, std::size_t limit_px) {
  TRY_ASSIGN(const std::vector<std::byte> bytes, read_file(path, kFileLimitBytes));
  // A JPEG stores its luma. Using it directly avoids a second rounding and takes a third of the time.
  auto grey = begins_with(bytes, kJpegMagic) ? JpegDecoder().decode_grey(bytes, limit_px) : grey_of(bytes, limit_px);
  if (!grey) return std::move(grey).error().while_doing(fmt::format("reading picture '{}'", path.string()));
  return grey;
}

RgbImage without_alpha(const RgbaImage& picture) {
  RgbImage rgb(picture.width(), picture.height());
  for (std::size_t i = 0; i < rgb.data().size(); ++i) rgb.data()[i] = picture.data()[i / 3 * 4 + i % 3];
  return rgb;
}

}  // namespace cyclorama
