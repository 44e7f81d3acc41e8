// SPDX-License-Identifier: Apache-2.0
/// JPEG by TurboJPEG: what crosses the network, and what photographs and textures come as.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "common/base/result.h"
#include "common/image/image.h"
#include "common/image/pixel_rect.h"
#include "common/image/planar_picture.h"

namespace cyclorama {

struct JpegOptions {
  int quality = 85;              ///< 1 to 100.
  bool subsample_chroma = true;  ///< 4:2:0, else 4:4:4.
};

/// Keeps TurboJPEG's state between pictures. Thread-bound: one per thread.
class JpegEncoder {
 public:
  JpegEncoder();
  ~JpegEncoder();
  JpegEncoder(JpegEncoder&&) noexcept;
  JpegEncoder& operator=(JpegEncoder&&) noexcept;

  /// `rgb` is `width` x `height` pixels of 3 bytes, rows `row_bytes` apart. kInvalidArgument  empty, or over 65500 px.
  Result<std::vector<std::byte>> encode(const std::uint8_t* rgb, int width, int height, std::size_t row_bytes,
                                        const JpegOptions& options);
  Result<std::vector<std::byte>> encode(const RgbImage& image, const JpegOptions& options);
  /// As in a JPEG of 4:4:4 without any loss but rounding's.
  PlanarPicture to_planar(const RgbImage& image);

 private:
  struct Handle;
  std::unique_ptr<Handle> handle_;
};

struct JpegSize {
  int width = 0;
  int height = 0;
};

/// What a JPEG's header says.
struct JpegHeader {
  JpegSize size;
  /// Whether its colours are kept as in a PlanarPicture with half chroma, or with full; nothing when they are kept in
  /// another way (grey, 4:2:2, CMYK...).
  std::optional<bool> has_half_chroma;
};

/// As JpegEncoder. Every error is kBadData and says what is wrong with the bytes; a picture that is cut short or
/// damaged is refused, never shown half.
class JpegDecoder {
 public:
  JpegDecoder();
  ~JpegDecoder();
  JpegDecoder(JpegDecoder&&) noexcept;
  JpegDecoder& operator=(JpegDecoder&&) noexcept;

  /// Read the header only.
  Result<JpegSize> size_of(std::span<const std::byte> jpeg);
  Result<JpegHeader> header_of(std::span<const std::byte> jpeg);
  /// Refuses more than `limit_px` pixels before it allocates anything.
  Result<RgbImage> decode(std::span<const std::byte> jpeg, std::size_t limit_px);
  Result<GreyImage> decode_grey(std::span<const std::byte> jpeg, std::size_t limit_px);
  /// Decodes into the caller's pixels. kBadData  also when the picture is not exactly `width` x `height`.
  Status decode_into(std::span<const std::byte> jpeg, std::uint8_t* rgb, int width, int height, std::size_t row_bytes);
  /// Decodes into a part of a picture without turning colours into RGB: about twice as quick. `place` lies inside, at
  /// even pixels, and ends at even ones or at the picture's edge. Several decoders may fill parts that do not overlap
  /// at once. kBadData  also when the JPEG has not exactly the part's size, or keeps its colours in another way.
  Status decode_into(std::span<const std::byte> jpeg, PlanarPicture* picture, const PixelRect& place);
  RgbImage to_rgb(const PlanarPicture& picture);

 private:
  struct Handle;
  std::unique_ptr<Handle> handle_;
};

}  // namespace cyclorama
