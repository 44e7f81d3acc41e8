// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "appliance/display/head_painter.h"
#include "common/geometry/picture_place.h"
#include "common/image/planar_picture.h"

namespace cyclorama {

/// CPU reference of the two render passes, in double precision and as simple as possible.
class ExactPicture {
 public:
  ExactPicture(const PlanarPicture& picture, const PictureShape& shape, double yaw_shift_rad)
      : shape_(shape), yaw_shift_rad_(yaw_shift_rad), light_(picture.width(), picture.height()) {
    for (int y = 0; y < picture.height(); ++y) {
      for (int x = 0; x < picture.width(); ++x) {
        const double luma = *picture.luma().at(x, y);
        const double blue = chroma(picture, picture.blue(), x, y);
        const double red = chroma(picture, picture.red(), x, y);
        const std::array<double, 3> codes{
            luma + 1.402 * red, luma - (0.114 * 1.772 * blue + 0.299 * 1.402 * red) / 0.587, luma + 1.772 * blue};
        for (std::size_t c = 0; c < 3; ++c) light_.at(x, y)[c] = linear(std::clamp(codes[c] / 255.0, 0.0, 1.0));
      }
    }
  }

  /// Returns the linear light at a pixel of the head, before the mask; nothing if the pixel is not drawn. The position
  /// in the picture is shifted by (`off_u`, `off_v`) pixels.
  [[nodiscard]] std::optional<Eigen::Vector3d> light_at(const warp::Warp& warp, int x, int y, double off_u = 0.0,
                                                        double off_v = 0.0) const {
    const auto position = among_centres(warp, x, y);
    if (!position) return std::nullopt;
    const double u = position->x() + off_u;
    const double v = position->y() + off_v;
    return Eigen::Vector3d(light(u, v, 0), light(u, v, 1), light(u, v, 2));
  }
  /// Returns the vector from the position of a head's pixel in the picture to the nearest pixel centre, in pixels of
  /// the picture; zero if the pixel is not drawn. The light has its extremes at pixel centres.
  [[nodiscard]] Eigen::Vector2d to_centre(const warp::Warp& warp, int x, int y) const {
    const auto position = among_centres(warp, x, y);
    return position ? Eigen::Vector2d(position->array().round() - position->array()) : Eigen::Vector2d(0.0, 0.0);
  }
  /// Returns unrounded code values in [0, 1]; black if the pixel is not drawn. Each light that contributes to the
  /// head's colours has a relative error of `error`, in the direction with the largest effect.
  [[nodiscard]] Eigen::Vector3d code_at(const display::HeadPlan& plan, int x, int y, double off_u = 0.0,
                                        double off_v = 0.0, double error = 0.0) const {
    const auto seen = light_at(plan.warp, x, y, off_u, off_v);
    if (!seen) return Eigen::Vector3d::Zero();
    const double black_lift = plan.colour.black_lift ? static_cast<double>(*plan.colour.black_lift->at(x, y)) : 0.0;
    const double weight = static_cast<double>(*plan.mask.at(x, y));
    if (weight == 0.0 && black_lift == 0.0) return Eigen::Vector3d::Zero();
    const Eigen::Vector3d light = *seen * weight;
    Eigen::Vector3d max = light;
    if (plan.colour.matrix) max = plan.colour.matrix->cwiseAbs() * light;
    return warp::codes_of(plan.colour, warp::shone_light(plan.colour, light, black_lift) +
                                           error * (max + black_lift * plan.colour.black));
  }

  /// Returns true if the pixel is not drawn.
  [[nodiscard]] bool is_black(const display::HeadPlan& plan, int x, int y) const {
    const double black_lift = plan.colour.black_lift ? static_cast<double>(*plan.colour.black_lift->at(x, y)) : 0.0;
    return (*plan.mask.at(x, y) == 0.0f && black_lift == 0.0) || !light_at(plan.warp, x, y);
  }
  /// Returns the minimum and maximum of the dither's contribution to a pixel's code values in [0, 1]. If the dither
  /// pattern jumps from one end of its range to the other near this pixel, both ends are possible.
  [[nodiscard]] static std::pair<double, double> dither_at(const display::HeadPlan& plan, int x, int y) {
    if (!plan.is_dithered) return {0.0, 0.0};
    constexpr double kLeap = 2e-3;  // Tolerance for a pattern that is computed in floats of up to several thousand.
    const double phase = (x + 0.5) * 0.7548776662 + (height_px(plan.warp) - y - 0.5) * 0.5698402910;
    const double at = phase - std::floor(phase) - 0.5;
    const double step = 1.0 / ((1 << plan.depth_bits) - 1);
    if (at < -0.5 + kLeap || at > 0.5 - kLeap) return {-0.5 * step, 0.5 * step};
    return {at * step, at * step};
  }

 private:
  static PanoramaPixel pixel_at(const Panorama& p, const PicturePlace& at) {
    return {(at.across / p.azimuth_span_rad + 0.5) * p.width_px,
            (at.up - p.tan_elevation_top) / (p.tan_elevation_bottom - p.tan_elevation_top) * p.height_px};
  }
  static PanoramaPixel pixel_at(const Perspective& p, const PicturePlace& at) {
    return {(at.across - p.tan_left) / (p.tan_right - p.tan_left) * p.width_px,
            (at.up - p.tan_top) / (p.tan_bottom - p.tan_top) * p.height_px};
  }
  static PanoramaPixel pixel_at(const Fisheye& p, const PicturePlace& at) {
    const double px_per_rad = std::min(p.width_px, p.height_px) / p.field_rad;
    return {0.5 * p.width_px + px_per_rad * at.across, 0.5 * p.height_px - px_per_rad * at.up};
  }
  static PanoramaPixel pixel_at(const Equirectangular&, const PicturePlace&) { return {}; }  // Never used for a wall.
  static double linear(double code) { return code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4); }
  static double chroma(const PlanarPicture& picture, const GreyImage& plane, int x, int y) {
    const double step = picture.has_half_chroma() ? 2.0 : 1.0;
    const double u = (x + 0.5) / step - 0.5;
    const double v = (y + 0.5) / step - 0.5;
    const auto at = [&](double column, double row) {
      return static_cast<double>(*plane.at(static_cast<int>(std::clamp(column, 0.0, plane.width() - 1.0)),
                                           static_cast<int>(std::clamp(row, 0.0, plane.height() - 1.0))));
    };
    return bilinear(u, v, at) - 128.0;
  }
  static double bilinear(double u, double v, const auto& at) {
    const double x = std::floor(u);
    const double y = std::floor(v);
    const double fx = u - x;
    const double fy = v - y;
    return (1 - fy) * ((1 - fx) * at(x, y) + fx * at(x + 1, y)) +
           fy * ((1 - fx) * at(x, y + 1) + fx * at(x + 1, y + 1));
  }
  /// Returns the position of a head's pixel in the picture; pixel centres are integers.
  [[nodiscard]] std::optional<Eigen::Vector2d> among_centres(const warp::Warp& warp, int x, int y) const {
    const auto seen = direction_at(warp, x, y);
    if (!seen) return std::nullopt;
    auto position = turned(shape_, {seen->azimuth_rad, seen->tan_elevation}, yaw_shift_rad_);
    if (!position) return std::nullopt;
    if (wraps())
      position->across -= 2.0 * std::numbers::pi * std::floor(position->across / (2.0 * std::numbers::pi) + 0.5);
    const PanoramaPixel pixel = std::visit([&](const auto& shape) { return pixel_at(shape, *position); }, shape_);
    return Eigen::Vector2d(pixel.u - 0.5, pixel.v - 0.5);
  }
  [[nodiscard]] bool wraps() const {
    const auto* panorama = std::get_if<Panorama>(&shape_);
    return panorama != nullptr && panorama->azimuth_span_rad > 6.28;
  }
  [[nodiscard]] double light(double u, double v, int channel) const {
    return bilinear(u, v, [&](double x, double y) {
      const double w = light_.width();
      const double column = wraps() ? x - w * std::floor(x / w) : std::clamp(x, 0.0, w - 1.0);
      const double row = std::clamp(y, 0.0, light_.height() - 1.0);
      return light_.at(static_cast<int>(column), static_cast<int>(row))[channel];
    });
  }

  PictureShape shape_;
  double yaw_shift_rad_;
  Image<double, 3> light_;
};

}  // namespace cyclorama
