// SPDX-License-Identifier: Apache-2.0
/// Pixels in memory, rows from the top, no padding.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/base/check.h"

namespace cyclorama {

/// A picture with `Channels` values per pixel. A value: copies copy the pixels. 8-bit colour is sRGB and float colour
/// is linear light, unless stated otherwise.
template <typename T, int Channels>
class Image {
 public:
  static constexpr int kChannels = Channels;

  Image() = default;
  Image(int width, int height, T fill = T{})
      : width_(width), height_(height), data_(count_of(width, height), fill) {}

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] bool empty() const { return data_.empty(); }
  /// Returns the first of the Channels values of a pixel. Precondition: (x, y) is inside.
  [[nodiscard]] T* at(int x, int y) { return data_.data() + index_of(x, y); }
  [[nodiscard]] const T* at(int x, int y) const { return data_.data() + index_of(x, y); }
  [[nodiscard]] std::span<T> data() { return data_; }
  [[nodiscard]] std::span<const T> data() const { return data_; }
  [[nodiscard]] std::size_t row_values() const { return static_cast<std::size_t>(width_) * Channels; }

  friend bool operator==(const Image&, const Image&) = default;

 private:
  static std::size_t count_of(int width, int height) {
    CHECK(width >= 0 && height >= 0);
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * Channels;
  }
  [[nodiscard]] std::size_t index_of(int x, int y) const {
    return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)) * Channels;
  }
  int width_ = 0;
  int height_ = 0;
  std::vector<T> data_;
};

using GreyImage = Image<std::uint8_t, 1>;
using RgbImage = Image<std::uint8_t, 3>;
using RgbaImage = Image<std::uint8_t, 4>;
using RadianceImage = Image<float, 3>;  ///< Linear light.

}  // namespace cyclorama
