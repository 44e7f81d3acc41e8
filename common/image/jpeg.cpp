// SPDX-License-Identifier: Apache-2.0
#include "common/image/jpeg.h"

#include <fmt/format.h>
#include <turbojpeg.h>

#include <array>
#include <limits>

namespace cyclorama {
namespace {
constexpr int kMaxSidePx = 65500;  // libjpeg's own limit.
// Without the limit on scans, a progressive file of a few kilobytes can take hours.
constexpr int kDecodeFlags = TJFLAG_STOPONWARNING | TJFLAG_LIMITSCANS;
}  // namespace

struct JpegEncoder::Handle {
  tjhandle tj = tjInitCompress();
  unsigned char* buffer = nullptr;  // Owned and grown by TurboJPEG; reused.
  unsigned long capacity = 0;
  Handle() { CHECK(tj != nullptr); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() {
    tjFree(buffer);
    tjDestroy(tj);
  }
};

JpegEncoder::JpegEncoder() : handle_(std::make_unique<Handle>()) {}
JpegEncoder::~JpegEncoder() = default;
JpegEncoder::JpegEncoder(JpegEncoder&&) noexcept = default;
JpegEncoder& JpegEncoder::operator=(JpegEncoder&&) noexcept = default;

Result<std::vector<std::byte>> JpegEncoder::encode(const std::uint8_t* rgb, int width, int height,
                                                   std::size_t row_bytes, const JpegOptions& options) {
  if (width < 1 || height < 1 || width > kMaxSidePx || height > kMaxSidePx ||
      row_bytes > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    return Error(ErrorCode::kInvalidArgument, fmt::format("a JPEG of {}x{} pixels cannot be written", width, height));
  }
  unsigned long size = handle_->capacity;
  if (tjCompress2(handle_->tj, rgb, width, static_cast<int>(row_bytes), height, TJPF_RGB, &handle_->buffer, &size,
                  options.subsample_chroma ? TJSAMP_420 : TJSAMP_444, options.quality, 0) != 0) {
    return Error(ErrorCode::kInvalidArgument, fmt::format("encoding JPEG: {}", tjGetErrorStr2(handle_->tj)));
  }
  handle_->capacity = std::max(handle_->capacity, size);
  const auto* const begin = reinterpret_cast<const std::byte*>(handle_->buffer);
  return std::vector<std::byte>(begin, begin + size);
}

Result<std::vector<std::byte>> JpegEncoder::encode(const RgbImage& image, const JpegOptions& options) {
  return encode(image.data().data(), image.width(), image.height(), image.row_values(), options);
}

PlanarPicture JpegEncoder::to_planar(const RgbImage& image) {
  PlanarPicture planar(image.width(), image.height(), false);
  if (image.empty()) return planar;
  std::array<unsigned char*, 3> planes{planar.luma().data().data(), planar.blue().data().data(),
                                       planar.red().data().data()};
  CHECK(tjEncodeYUVPlanes(handle_->tj, image.data().data(), image.width(), static_cast<int>(image.row_values()),
                          image.height(), TJPF_RGB, planes.data(), nullptr, TJSAMP_444, 0) == 0);
  return planar;
}

struct JpegDecoder::Handle {
  tjhandle tj = tjInitDecompress();
  Handle() { CHECK(tj != nullptr); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() { tjDestroy(tj); }

  /// Recreates the decoder: after bad bytes, TurboJPEG 2.1 keeps part of them and would refuse the next good picture.
  Error bad(const char* doing) {
    Error error(ErrorCode::kBadData, fmt::format("{}: {}", doing, tjGetErrorStr2(tj)));
    tjDestroy(tj);
    tj = tjInitDecompress();
    CHECK(tj != nullptr);
    return error;
  }
  Status decode(std::span<const std::byte> jpeg, unsigned char* pixels, int width, int height, std::size_t row_bytes,
                int format) {
    if (tjDecompress2(tj, reinterpret_cast<const unsigned char*>(jpeg.data()), jpeg.size(), pixels, width,
                      static_cast<int>(row_bytes), height, format, kDecodeFlags) != 0) {
      return bad("decoding JPEG");
    }
    return Done{};
  }
};

JpegDecoder::JpegDecoder() : handle_(std::make_unique<Handle>()) {}
JpegDecoder::~JpegDecoder() = default;
JpegDecoder::JpegDecoder(JpegDecoder&&) noexcept = default;
JpegDecoder& JpegDecoder::operator=(JpegDecoder&&) noexcept = default;

Result<JpegHeader> JpegDecoder::header_of(std::span<const std::byte> jpeg) {
  JpegHeader header;
  JpegSize& size = header.size;
  int subsampling = 0;
  int colourspace = 0;
  if (tjDecompressHeader3(handle_->tj, reinterpret_cast<const unsigned char*>(jpeg.data()), jpeg.size(), &size.width,
                          &size.height, &subsampling, &colourspace) != 0) {
    return handle_->bad("reading the JPEG header");
  }
  if (size.width < 1 || size.height < 1) return Error(ErrorCode::kBadData, "the JPEG header gives no size");
  if (colourspace == TJCS_YCbCr && (subsampling == TJSAMP_420 || subsampling == TJSAMP_444)) {
    header.has_half_chroma = subsampling == TJSAMP_420;
  }
  return header;
}

Result<JpegSize> JpegDecoder::size_of(std::span<const std::byte> jpeg) {
  TRY_ASSIGN(const JpegHeader header, header_of(jpeg));
  return header.size;
}

namespace {
Status check_limit(JpegSize size, std::size_t limit_px) {
  if (static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height) <= limit_px) return Done{};
  return Error(ErrorCode::kBadData, fmt::format("the JPEG has {}x{} pixels; at most {} pixels are accepted here",
                                                size.width, size.height, limit_px));
}
Status check_size(JpegSize size, int width, int height) {
  if (size.width == width && size.height == height) return Done{};
  return Error(ErrorCode::kBadData, fmt::format("the JPEG has {}x{} pixels where {}x{} were announced", size.width,
                                                size.height, width, height));
}
}  // namespace

Result<RgbImage> JpegDecoder::decode(std::span<const std::byte> jpeg, std::size_t limit_px) {
  TRY_ASSIGN(const JpegSize size, size_of(jpeg));
  TRY(check_limit(size, limit_px));
  RgbImage image(size.width, size.height);
  TRY(handle_->decode(jpeg, image.data().data(), size.width, size.height, image.row_values(), TJPF_RGB));
  return image;
}

Result<GreyImage> JpegDecoder::decode_grey(std::span<const std::byte> jpeg, std::size_t limit_px) {
  TRY_ASSIGN(const JpegSize size, size_of(jpeg));
  TRY(check_limit(size, limit_px));
  GreyImage image(size.width, size.height);
  TRY(handle_->decode(jpeg, image.data().data(), size.width, size.height, image.row_values(), TJPF_GRAY));
  return image;
}

Status JpegDecoder::decode_into(std::span<const std::byte> jpeg, std::uint8_t* rgb, int width, int height,
                                std::size_t row_bytes) {
  TRY_ASSIGN(const JpegSize size, size_of(jpeg));
  TRY(check_size(size, width, height));
  return handle_->decode(jpeg, rgb, width, height, row_bytes, TJPF_RGB);
}

Status JpegDecoder::decode_into(std::span<const std::byte> jpeg, PlanarPicture* picture, const PixelRect& place) {
  const auto ends_well = [](int end, int whole) { return end == whole || (end < whole && end % 2 == 0); };
  CHECK(!place.empty() && place.x >= 0 && place.y >= 0 && place.x % 2 == 0 && place.y % 2 == 0 &&
        ends_well(place.x + place.width, picture->width()) && ends_well(place.y + place.height, picture->height()));
  TRY_ASSIGN(const JpegHeader header, header_of(jpeg));
  TRY(check_size(header.size, place.width, place.height));
  const bool half = picture->has_half_chroma();
  if (header.has_half_chroma != half) {
    return Error(ErrorCode::kBadData, fmt::format("the JPEG's colours are not kept as {}", half ? "4:2:0" : "4:4:4"));
  }
  const int step = half ? 2 : 1;
  std::array<unsigned char*, 3> planes{picture->luma().at(place.x, place.y),
                                       picture->blue().at(place.x / step, place.y / step),
                                       picture->red().at(place.x / step, place.y / step)};
  std::array<int, 3> strides{picture->luma().width(), picture->blue().width(), picture->red().width()};
  if (tjDecompressToYUVPlanes(handle_->tj, reinterpret_cast<const unsigned char*>(jpeg.data()), jpeg.size(),
                              planes.data(), place.width, strides.data(), place.height, kDecodeFlags) != 0) {
    return handle_->bad("decoding JPEG");
  }
  return Done{};
}

RgbImage JpegDecoder::to_rgb(const PlanarPicture& picture) {
  RgbImage image(picture.width(), picture.height());
  if (image.empty()) return image;
  std::array<const unsigned char*, 3> planes{picture.luma().data().data(), picture.blue().data().data(),
                                             picture.red().data().data()};
  const std::array<int, 3> strides{picture.luma().width(), picture.blue().width(), picture.red().width()};
  CHECK(tjDecodeYUVPlanes(handle_->tj, planes.data(), strides.data(),
                          picture.has_half_chroma() ? TJSAMP_420 : TJSAMP_444, image.data().data(), image.width(),
                          static_cast<int>(image.row_values()), image.height(), TJPF_RGB, 0) == 0);
  return image;
}

}  // namespace cyclorama
