// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/image/image.h"

namespace cyclorama {

/// A picture as stored in JPEG: luma, and two colour differences that have the same number of pixels (4:4:4), or half
/// the number in each direction (4:2:0), so that each is centred on four luma pixels. Code values are those of JFIF: R
/// = Y + 1.402 (Cr - 128), and so on. A value: copies copy the pixels.
class PlanarPicture {
 public:
  PlanarPicture() = default;
  PlanarPicture(int width, int height, bool has_half_chroma)
      : width_(width),
        height_(height),
        has_half_chroma_(has_half_chroma),
        luma_(has_half_chroma ? 2 * half(width) : width, has_half_chroma ? 2 * half(height) : height),
        blue_(has_half_chroma ? half(width) : width, has_half_chroma ? half(height) : height, kGrey),
        red_(blue_) {}

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] bool has_half_chroma() const { return has_half_chroma_; }
  /// Luma. With half chroma, a picture of odd size has an additional column or row, to complete the groups of four.
  [[nodiscard]] GreyImage& luma() { return luma_; }
  [[nodiscard]] const GreyImage& luma() const { return luma_; }
  [[nodiscard]] GreyImage& blue() { return blue_; }  ///< Cb
  [[nodiscard]] const GreyImage& blue() const { return blue_; }
  [[nodiscard]] GreyImage& red() { return red_; }  ///< Cr
  [[nodiscard]] const GreyImage& red() const { return red_; }

 private:
  static constexpr std::uint8_t kGrey = 128;
  static int half(int px) { return (px + 1) / 2; }

  int width_ = 0;
  int height_ = 0;
  bool has_half_chroma_ = false;
  GreyImage luma_;
  GreyImage blue_;
  GreyImage red_;
};

}  // namespace cyclorama
