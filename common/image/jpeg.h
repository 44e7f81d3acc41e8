// SPDX-License-Identifier: Apache-2.0
/// JPEG with TurboJPEG, for transmission, photographs and textures.
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
  bool subsample_chroma = true;  ///< True: 4:2:0; false: 4:4:4.
};

/// Encodes JPEG; keeps TurboJPEG's state between pictures. Thread-bound: one per thread.
class JpegEncoder {
 public:
  JpegEncoder();
  ~JpegEncoder();
  JpegEncoder(JpegEncoder&&) noexcept;
  JpegEncoder& operator=(JpegEncoder&&) noexcept;

  /// Encodes `width` x `height` pixels of 3 bytes, in rows `row_bytes` apart. Errors: kInvalidArgument if the picture
  /// is empty or a side exceeds 65500 px.
  Result<std::vector<std::byte>> encode(const std::uint8_t* rgb, int width, int height, std::size_t row_bytes,
                                        const JpegOptions& options);
  Result<std::vector<std::byte>> encode(const RgbImage& image, const JpegOptions& options);
  /// Converts like a 4:4:4 JPEG, but without any loss except rounding.
  PlanarPicture to_planar(const RgbImage& image);

 private:
  struct Handle;
  std::unique_ptr<Handle> handle_;
};

struct JpegSize {
  int width = 0;
  int height = 0;
};

/// Contents of a JPEG's header.
struct JpegHeader {
  JpegSize size;
  /// True if the colours are stored as in a PlanarPicture with half chroma, false if as in one with full chroma; empty
  /// if they are stored in another way (grey, 4:2:2, CMYK...).
  std::optional<bool> has_half_chroma;
};

/// Decodes JPEG. Thread-bound: one per thread. Every error is kBadData and names the fault; a truncated or damaged
/// picture is refused, never returned in part.
class JpegDecoder {
 public:
  JpegDecoder();
  ~JpegDecoder();
  JpegDecoder(JpegDecoder&&) noexcept;
  JpegDecoder& operator=(JpegDecoder&&) noexcept;

  /// Reads only the header.
  Result<JpegSize> size_of(std::span<const std::byte> jpeg);
  Result<JpegHeader> header_of(std::span<const std::byte> jpeg);
  /// Decodes a picture; refuses more than `limit_px` pixels before allocating anything.
  Result<RgbImage> decode(std::span<const std::byte> jpeg, std::size_t limit_px);
  Result<GreyImage> decode_grey(std::span<const std::byte> jpeg, std::size_t limit_px);
  /// Decodes into the caller's pixels. Errors: kBadData also if the picture is not exactly `width` x `height`.
  Status decode_into(std::span<const std::byte> jpeg, std::uint8_t* rgb, int width, int height, std::size_t row_bytes);
  /// Decodes into a part of a picture without conversion to RGB, which is about twice as fast. Several decoders may
  /// fill disjoint parts at the same time. Precondition: `place` lies inside the picture, begins at even pixels, and
  /// ends at even pixels or at the picture's edge. Errors: kBadData also if the JPEG does not have exactly the size of
  /// the part, or stores its colours in another way than `picture`.
  Status decode_into(std::span<const std::byte> jpeg, PlanarPicture* picture, const PixelRect& place);
  RgbImage to_rgb(const PlanarPicture& picture);

 private:
  struct Handle;
  std::unique_ptr<Handle> handle_;
};

}  // namespace cyclorama
