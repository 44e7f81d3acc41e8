// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/picture_place.h"

#include <Eigen/Geometry>

namespace cyclorama {
namespace {

double tilt_of(const Panorama&) { return 0.0; }
double tilt_of(const Perspective& s) { return s.tilt_rad; }
double tilt_of(const Fisheye& s) { return s.tilt_rad; }
double tilt_of(const Equirectangular&) { return 0.0; }
double tilt_of(const PictureShape& shape) {
  return std::visit([](const auto& s) { return tilt_of(s); }, shape);
}

/// Linear map from a span to pixels: factor, and position of the value 0.
struct Spread {
  double px_per_unit;
  double offset_px;
};
Spread spread(double first, double last, int px) {
  const double per_unit = px / (last - first);
  return {per_unit, -first * per_unit};
}
PixelScale scale_of(const Spread& across, const Spread& up) {
  return {across.px_per_unit, across.offset_px, up.px_per_unit, up.offset_px};
}

PixelScale scale(const Panorama& s) {
  // The middle column is azimuth 0, independent of rounding at the edges.
  const double px_per_rad = 1.0 / s.radians_per_px();
  return scale_of({px_per_rad, 0.5 * s.width_px}, spread(s.tan_elevation_top, s.tan_elevation_bottom, s.height_px));
}
PixelScale scale(const Perspective& s) {
  return scale_of(spread(s.tan_left, s.tan_right, s.width_px), spread(s.tan_top, s.tan_bottom, s.height_px));
}
PixelScale scale(const Fisheye& s) {
  const double px_per_rad = 1.0 / s.radians_per_px();
  return scale_of({px_per_rad, 0.5 * s.width_px}, {-px_per_rad, 0.5 * s.height_px});
}
PixelScale scale(const Equirectangular& s) {
  return scale_of({s.width_px / s.azimuth_span_rad, 0.5 * s.width_px},
                  spread(s.elevation_top_rad, s.elevation_bottom_rad, s.height_px));
}

// The functions below return directions in the picture's axes.

Eigen::Vector3d direction(const Panorama&, const PicturePlace& p) {
  return {std::sin(p.across), p.up, -std::cos(p.across)};
}
Eigen::Vector3d direction(const Perspective&, const PicturePlace& p) { return {p.across, p.up, -1.0}; }
Eigen::Vector3d direction(const Fisheye&, const PicturePlace& p) {
  const double angle = std::hypot(p.across, p.up);
  const double sideways = angle > 0.0 ? std::sin(angle) / angle : 0.0;
  return {sideways * p.across, sideways * p.up, -std::cos(angle)};
}
Eigen::Vector3d direction(const Equirectangular&, const PicturePlace& p) {
  return {std::sin(p.across) * std::cos(p.up), std::sin(p.up), -std::cos(p.across) * std::cos(p.up)};
}

std::optional<PicturePlace> place(const Panorama&, const Eigen::Vector3d& d) {
  if (d.x() == 0.0 && d.z() == 0.0) return std::nullopt;
  return PicturePlace{std::atan2(d.x(), -d.z()), d.y() / std::hypot(d.x(), d.z())};
}
std::optional<PicturePlace> place(const Perspective&, const Eigen::Vector3d& d) {
  if (!(d.z() < 0.0)) return std::nullopt;
  return PicturePlace{d.x() / -d.z(), d.y() / -d.z()};
}
std::optional<PicturePlace> place(const Fisheye&, const Eigen::Vector3d& d) {
  const double sideways = std::hypot(d.x(), d.y());
  if (sideways == 0.0) return d.z() < 0.0 ? std::optional(PicturePlace{}) : std::nullopt;
  const double stretch = std::atan2(sideways, -d.z()) / sideways;
  return PicturePlace{stretch * d.x(), stretch * d.y()};
}
std::optional<PicturePlace> place(const Equirectangular&, const Eigen::Vector3d& d) {
  return PicturePlace{std::atan2(d.x(), -d.z()), std::atan2(d.y(), std::hypot(d.x(), d.z()))};
}

}  // namespace

PixelScale pixel_scale(const PictureShape& shape) {
  return std::visit([](const auto& s) { return scale(s); }, shape);
}

PictureShape with_pixels(PictureShape shape, int width_px, int height_px) {
  std::visit(
      [&](auto& s) {
        s.width_px = width_px;
        s.height_px = height_px;
      },
      shape);
  return shape;
}

bool has_same_places(const PictureShape& a, const PictureShape& b) {
  return a.index() == b.index() && tilt_of(a) == tilt_of(b);
}

Eigen::Matrix3d R_eye_picture(const PictureShape& shape) {
  return Eigen::AngleAxisd(tilt_of(shape), Eigen::Vector3d::UnitX()).toRotationMatrix();
}

Eigen::Vector3d direction_of(const PictureShape& shape, const PicturePlace& at) {
  return R_eye_picture(shape) * std::visit([&](const auto& s) { return direction(s, at); }, shape);
}

std::optional<PicturePlace> place_of(const PictureShape& shape, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d d = R_eye_picture(shape).transpose() * direction;
  return std::visit([&](const auto& s) { return place(s, d); }, shape);
}

std::optional<PicturePlace> turned(const PictureShape& shape, const PicturePlace& at, double turn_rad) {
  if (std::holds_alternative<Panorama>(shape) || std::holds_alternative<Equirectangular>(shape)) {
    return PicturePlace{at.across + turn_rad, at.up};
  }
  return place_of(shape, Eigen::AngleAxisd(-turn_rad, Eigen::Vector3d::UnitY()) * direction_of(shape, at));
}

}  // namespace cyclorama
