// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/projection.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "common/geometry/picture_place.h"

namespace cyclorama {
namespace {

constexpr int kMaxSidePx = 16384;
constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kRounding = 1e-9;  // Tolerance for angles that were converted from degrees and text.

Error refuse(std::string_view shape, std::string_view field, double value, std::string_view legal) {
  return Error(ErrorCode::kInvalidArgument, fmt::format("{} {} is {}; it must be {}", shape, field, value, legal));
}

Status check_size(std::string_view shape, int width, int height) {
  if (width < 1 || width > kMaxSidePx) return refuse(shape, "width_px", width, "1 to 16384");
  if (height < 1 || height > kMaxSidePx) return refuse(shape, "height_px", height, "1 to 16384");
  return Done{};
}

// The comparisons below are written so that NaN is refused.
Status check_tilt(std::string_view shape, double tilt) {
  if (std::abs(tilt) <= std::numbers::pi + kRounding) return Done{};
  return refuse(shape, "tilt_rad", tilt, "within half a turn");
}

Status check(const Panorama& s) { return s.validate(); }

Status check(const Perspective& s) {
  TRY(check_size("perspective", s.width_px, s.height_px));
  if (!std::isfinite(s.tan_left)) return refuse("perspective", "tan_left", s.tan_left, "finite");
  if (!std::isfinite(s.tan_right) || !(s.tan_right > s.tan_left)) {
    return refuse("perspective", "tan_right", s.tan_right, "finite and above tan_left");
  }
  if (!std::isfinite(s.tan_bottom)) return refuse("perspective", "tan_bottom", s.tan_bottom, "finite");
  if (!std::isfinite(s.tan_top) || !(s.tan_top > s.tan_bottom)) {
    return refuse("perspective", "tan_top", s.tan_top, "finite and above tan_bottom");
  }
  return check_tilt("perspective", s.tilt_rad);
}

Status check(const Fisheye& s) {
  TRY(check_size("fisheye", s.width_px, s.height_px));
  if (!(s.field_rad > 0.0 && s.field_rad <= kTurn + kRounding)) {
    return refuse("fisheye", "field_rad", s.field_rad, "above 0 and at most 2 pi");
  }
  return check_tilt("fisheye", s.tilt_rad);
}

Status check(const Equirectangular& s) {
  constexpr const char* kName = "equirectangular";
  constexpr double kQuarter = 0.25 * kTurn + kRounding;
  TRY(check_size(kName, s.width_px, s.height_px));
  if (!(s.azimuth_span_rad > 0.0 && s.azimuth_span_rad <= kTurn + kRounding)) {
    return refuse(kName, "azimuth_span_rad", s.azimuth_span_rad, "above 0 and at most 2 pi");
  }
  if (!(s.elevation_bottom_rad >= -kQuarter)) {
    return refuse(kName, "elevation_bottom_rad", s.elevation_bottom_rad, "at least -pi/2");
  }
  if (!(s.elevation_top_rad <= kQuarter && s.elevation_top_rad > s.elevation_bottom_rad)) {
    return refuse(kName, "elevation_top_rad", s.elevation_top_rad, "at most pi/2 and above elevation_bottom_rad");
  }
  return Done{};
}

/// True if both eyes are on the sweet spot's side of the screen.
bool in_front_of_screen(const Projection& p) {
  const Viewing& v = p.viewing;
  const double half = 0.5 * v.eye_distance_m;
  if (std::holds_alternative<Panorama>(p.shape)) {
    return std::hypot(v.viewer_m.x(), v.viewer_m.z()) + half < v.screen_distance_m;
  }
  if (std::holds_alternative<Perspective>(p.shape)) {
    return -(R_eye_picture(p.shape).transpose() * v.viewer_m).z() < v.screen_distance_m;
  }
  return v.viewer_m.norm() + half < v.screen_distance_m;
}

/// Returns the direction to the right of an eye that faces `direction`, of length 1, or less near the poles of a
/// sphere.
Eigen::Vector3d rightwards(const Projection& p, const Eigen::Vector3d& direction) {
  if (std::holds_alternative<Perspective>(p.shape)) return Eigen::Vector3d::UnitX();
  const Eigen::Vector3d right(-direction.z(), 0.0, direction.x());
  if (std::holds_alternative<Panorama>(p.shape)) return right;
  const double fade = std::max(std::sin(p.viewing.pole_fade_rad), std::numeric_limits<double>::min());
  return right / std::max(right.norm(), fade);
}

}  // namespace

Perspective Perspective::from_field(int width_px, int height_px, double field_rad, double tilt_rad) {
  const double tan_right = std::tan(0.5 * field_rad);
  const double tan_top = tan_right * height_px / width_px;
  return {width_px, height_px, -tan_right, tan_right, tan_top, -tan_top, tilt_rad};
}

int width_px(const PictureShape& shape) {
  return std::visit([](const auto& s) { return s.width_px; }, shape);
}

int height_px(const PictureShape& shape) {
  return std::visit([](const auto& s) { return s.height_px; }, shape);
}

Status validate(const PictureShape& shape) {
  return std::visit([](const auto& s) { return check(s); }, shape);
}

std::optional<Eigen::Vector3d> direction_at(const PictureShape& shape, PanoramaPixel p) {
  if (const auto* fisheye = std::get_if<Fisheye>(&shape)) {
    const double from_middle = std::hypot(p.u - 0.5 * fisheye->width_px, p.v - 0.5 * fisheye->height_px);
    if (from_middle > fisheye->radius_px()) return std::nullopt;
  }
  if (const auto* panorama = std::get_if<Panorama>(&shape)) return panorama->direction_at(p);
  return direction_of(shape, pixel_scale(shape).place_at(p));
}

std::optional<PanoramaPixel> pixel_of(const PictureShape& shape, const Eigen::Vector3d& direction) {
  const std::optional<PicturePlace> place = place_of(shape, direction);
  if (!place) return std::nullopt;
  const auto* fisheye = std::get_if<Fisheye>(&shape);
  if (fisheye != nullptr && !(std::hypot(place->across, place->up) <= 0.5 * fisheye->field_rad)) return std::nullopt;
  return pixel_scale(shape).pixel_at(*place);
}

int Projection::height_px() const { return cyclorama::height_px(shape) * stacked(); }

Status Projection::validate() const {
  TRY(cyclorama::validate(shape));
  const Viewing& v = viewing;
  if (height_px() > kMaxSidePx) {
    return refuse("over-under picture", "height_px", height_px(), "at most 16384 for both eyes");
  }
  if (!(std::isfinite(v.eye_distance_m) && v.eye_distance_m >= 0.0)) {
    return refuse("viewing", "eye_distance_m", v.eye_distance_m, "finite and not negative");
  }
  if (!(v.screen_distance_m > 0.0)) {
    return refuse("viewing", "screen_distance_m", v.screen_distance_m, "above 0, perhaps infinite");
  }
  if (!(v.pole_fade_rad >= 0.0 && v.pole_fade_rad <= 0.25 * kTurn + kRounding)) {
    return refuse("viewing", "pole_fade_rad", v.pole_fade_rad, "0 to pi/2");
  }
  if (!v.viewer_m.allFinite()) return Error(ErrorCode::kInvalidArgument, "viewing viewer_m is not finite");
  if (in_front_of_screen(*this)) return Done{};
  return refuse("viewing", "screen_distance_m", v.screen_distance_m,
                "so large that both eyes are in front of the screen");
}

std::optional<EyeRay> Projection::ray_at(PanoramaPixel p) const {
  double side = viewing.eyes == Eyes::kMono ? 0.0 : viewing.eyes == Eyes::kRight ? 0.5 : -0.5;
  if (viewing.eyes == Eyes::kOverUnder && p.v >= cyclorama::height_px(shape)) {
    side = 0.5;
    p.v -= cyclorama::height_px(shape);
  }
  const std::optional<Eigen::Vector3d> direction = direction_at(shape, p);
  if (!direction) return std::nullopt;
  const Eigen::Vector3d eye = viewing.viewer_m + side * viewing.eye_distance_m * rightwards(*this, *direction);
  return EyeRay{eye, (*direction - eye / viewing.screen_distance_m).normalized()};
}

}  // namespace cyclorama
