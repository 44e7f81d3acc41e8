// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "appliance/warp/blend_mask.h"
#include "appliance/warp/pixel_map.h"

namespace cyclorama {

/// CPU reference of pass 2, in double precision and as simple as possible.
class WarpedPicture {
 public:
  WarpedPicture(const RgbImage& picture, const PictureShape& shape, double turn_rad)
      : picture_(picture), shape_(shape), scale_(pixel_scale(shape)), turn_rad_(turn_rad) {}

  /// Returns unrounded code values in [0, 255] of a pixel of the head; black if the pixel is not drawn. The position in
  /// the picture is shifted by (`off_u`, `off_v`) pixels.
  [[nodiscard]] std::array<double, 3> at(const warp::Warp& warp, const warp::MaskImage& mask, int x, int y,
                                         double off_u = 0.0, double off_v = 0.0) const {
    const auto seen = direction_at(warp, x, y);
    const auto position = seen ? turned(shape_, {seen->azimuth_rad, seen->tan_elevation}, turn_rad_) : std::nullopt;
    if (!position) return {0.0, 0.0, 0.0};
    const double weight = static_cast<double>(*mask.at(x, y));
    const PanoramaPixel pixel = scale_.pixel_at(*position);
    const double turn_px = 2.0 * std::numbers::pi * scale_.u_per_across;
    const double u = (wraps() ? pixel.u - turn_px * std::floor(pixel.u / turn_px) : pixel.u) + off_u - 0.5;
    const double v = pixel.v + off_v - 0.5;
    std::array<double, 3> codes{};
    for (int c = 0; c < 3; ++c) codes[static_cast<std::size_t>(c)] = 255.0 * encoded(weight * light(u, v, c));
    return codes;
  }

 private:
  [[nodiscard]] bool wraps() const {
    const auto* panorama = std::get_if<Panorama>(&shape_);
    return panorama != nullptr && panorama->azimuth_span_rad > 6.28;
  }
  [[nodiscard]] double texel(double x, double y, int channel) const {
    const double w = picture_.width();
    const double column = wraps() ? x - w * std::floor(x / w) : std::clamp(x, 0.0, w - 1.0);
    const double row = std::clamp(y, 0.0, picture_.height() - 1.0);
    const double code = picture_.at(static_cast<int>(column), static_cast<int>(row))[channel] / 255.0;
    return code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4);
  }
  [[nodiscard]] double light(double u, double v, int c) const {
    const double x = std::floor(u);
    const double y = std::floor(v);
    const double fx = u - x;
    const double fy = v - y;
    return (1 - fy) * ((1 - fx) * texel(x, y, c) + fx * texel(x + 1, y, c)) +
           fy * ((1 - fx) * texel(x, y + 1, c) + fx * texel(x + 1, y + 1, c));
  }
  static double encoded(double light) {
    return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1.0 / 2.4) - 0.055;
  }

  const RgbImage& picture_;
  PictureShape shape_;
  PixelScale scale_;
  double turn_rad_;
};

}  // namespace cyclorama
