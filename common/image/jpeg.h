// SPDX-License-Identifier: Apache-2.0
/// JPEG by TurboJPEG: what crosses the network, and what photographs and textures come as.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "common/base/result.h"
#include "common/image/image.h"

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

 private:
  struct Handle;
  std::unique_ptr<Handle> handle_;
};

struct JpegSize {
  int width = 0;
  int height = 0;
};

/// As JpegEncoder. Every error is kBadData and says what is wrong with the bytes; a picture that is cut short or
/// damaged is refused, never shown half.
class JpegDecoder {
 public:
  JpegDecoder();
  ~JpegDecoder();
  JpegDecoder(JpegDecoder&&) noexcept;
  JpegDecoder& operator=(JpegDecoder&&) noexcept;

  /// Reads the header only.
  Result<JpegSize> size_of(std::span<const std::byte> jpeg);
  /// Refuses more than `limit_px` pixels before it allocates anything.
  Result<RgbImage> decode(std::span<const std::byte> jpeg, std::size_t limit_px);
  Result<GreyImage> decode_grey(std::span<const std::byte> jpeg, std::size_t limit_px);
  /// Decodes into the caller's pixels. kBadData  also when the picture is not exactly `width` x `height`.
  Status decode_into(std::span<const std::byte> jpeg, std::uint8_t* rgb, int width, int height, std::size_t row_bytes);

 private:
  struct Handle;
  std::unique_ptr<Handle> handle_;
};

}  // namespace cyclorama
