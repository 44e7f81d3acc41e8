// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace cyclorama::denoise {

/// One value per pixel, rows from the top. Unlike an Image, keeps its memory when resized. A value.
class Plane {
 public:
  /// Changes the size. Pixel values are unspecified afterwards.
  void reshape(int width, int height) {
    width_ = width;
    height_ = height;
    values_.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  }
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  /// Precondition: (x, y) is inside the plane.
  [[nodiscard]] float* at(int x, int y) { return values_.data() + index_of(x, y); }
  [[nodiscard]] const float* at(int x, int y) const { return values_.data() + index_of(x, y); }
  [[nodiscard]] std::span<float> data() { return values_; }
  [[nodiscard]] std::span<const float> data() const { return values_; }

 private:
  [[nodiscard]] std::size_t index_of(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }
  int width_ = 0;
  int height_ = 0;
  std::vector<float> values_;
};

}  // namespace cyclorama::denoise
