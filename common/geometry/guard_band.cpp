// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/guard_band.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/base/picture_cut.h"
#include "common/geometry/picture_place.h"

namespace cyclorama {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kEndless = std::numeric_limits<double>::infinity();
constexpr int kMaxSidePx = 16384;
// Tangent of 80 degrees; beyond it, a flat picture consists mostly of its border.
constexpr double kMaxTangent = 5.671;
constexpr double kMaxElevation_rad = 80.0 * std::numbers::pi / 180.0;
constexpr double kSameEdge = 1e-9;  // In tangents; a tolerance, so that an unturned picture lies inside itself.

int whole_px(double px) { return static_cast<int>(std::clamp(std::ceil(px - 1e-6), 1.0, double{kMaxSidePx})); }
int cut_px(double px) { return std::min((whole_px(px) + kCutPx - 1) / kCutPx * kCutPx, kMaxSidePx); }

/// Extent of a perspective picture, in tangents.
struct Extent {
  double left;
  double right;
  double top;
  double bottom;
};

/// Returns the extent of all positions that a picture shows when turned by `turn_rad` either way; empty if a corner
/// would be too far out. Straight lines stay straight, so the corners suffice.
std::optional<Extent> swept(const Perspective& p, double turn_rad) {
  Extent extent{p.tan_left, p.tan_right, p.tan_top, p.tan_bottom};
  for (const double turn : {-turn_rad, turn_rad}) {
    for (const double across : {p.tan_left, p.tan_right}) {
      for (const double up : {p.tan_top, p.tan_bottom}) {
        const auto at = turned(p, {across, up}, turn);
        if (!at || !(std::max(std::abs(at->across), std::abs(at->up)) <= kMaxTangent)) return std::nullopt;
        extent = {std::min(extent.left, at->across), std::max(extent.right, at->across), std::max(extent.top, at->up),
                  std::min(extent.bottom, at->up)};
      }
    }
  }
  return extent;
}

/// Returns the largest turn up to `max` for which `is_possible` is true. If it is true for a turn, it must be true for
/// all smaller ones.
double max_turn(double max, const auto& is_possible) {
  if (is_possible(max)) return max;
  double possible = 0.0;
  double not_possible = max;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (possible + not_possible);
    (is_possible(middle) ? possible : not_possible) = middle;
  }
  return possible;
}

/// Returns the tangent of an elevation that is `angle_rad` higher, but at most the limit. A tangent beyond the limit
/// stays.
double raised(double tangent, double angle_rad) {
  const double elevation = std::atan(tangent);
  if (std::abs(elevation) >= kMaxElevation_rad) return tangent;
  return std::tan(std::clamp(elevation + angle_rad, -kMaxElevation_rad, kMaxElevation_rad));
}

/// Returns the smallest c >= p such that all directions within `parallax` of (p, q, 1) lie on the near side of the
/// plane x = c z. The sine of the angle between the direction and the plane is (c - p) / sqrt((1 + c²) (1 + p² + q²)).
double cleared(double p, double q, double parallax) {
  const double s = std::sin(parallax);
  const double k = s * s * (1.0 + p * p + q * q);
  if (!(k < 1.0)) return kMaxTangent;
  return (p + std::sqrt(std::max(0.0, k * (1.0 + p * p - k)))) / (1.0 - k);
}

/// Returns the extent enlarged by `parallax` on all sides. An edge beyond the limit stays.
Extent cleared(const Extent& e, double parallax) {
  const double across = std::max(std::abs(e.left), std::abs(e.right));
  const double up = std::max(std::abs(e.top), std::abs(e.bottom));
  const auto edge = [parallax](double p, double q) {
    return std::max(p, std::min(cleared(p, q, parallax), kMaxTangent));
  };
  return {-edge(-e.left, up), edge(e.right, up), edge(e.top, across), -edge(-e.bottom, across)};
}

PictureShape grown(const Panorama& p, double guard, double parallax) {
  // The higher a cone's direction, the more azimuth the cone covers.
  const double highest = std::atan(std::max(std::abs(p.tan_elevation_top), std::abs(p.tan_elevation_bottom)));
  const double aside = std::asin(std::min(1.0, std::sin(parallax) / std::cos(highest)));
  Panorama grown = p.with_guard_band(guard + aside);
  if (!(parallax > 0.0)) return grown;
  const double rows_per_tan = p.height_px / (p.tan_elevation_top - p.tan_elevation_bottom);
  const double above = raised(p.tan_elevation_top, parallax) - p.tan_elevation_top;
  const double below = p.tan_elevation_bottom - raised(p.tan_elevation_bottom, -parallax);
  // Whole rows on either side, so that the wall's rows do not move relative to the pixels.
  const int room = kMaxSidePx - p.height_px;
  const int above_px = std::clamp(static_cast<int>(std::ceil(above * rows_per_tan - 1e-6)), 0, room / 2);
  const int below_px = std::clamp(static_cast<int>(std::ceil(below * rows_per_tan - 1e-6)), 0, room / 2);
  grown.height_px += above_px + below_px;
  grown.tan_elevation_top += above_px / rows_per_tan;
  grown.tan_elevation_bottom -= below_px / rows_per_tan;
  return grown;
}
PictureShape grown(const Perspective& p, double guard, double parallax) {
  auto extent = swept(p, max_turn(guard, [&](double turn) { return swept(p, turn).has_value(); }));
  if (!extent) return p;
  if (parallax > 0.0) extent = cleared(*extent, parallax);
  const double across_px = p.width_px / (p.tan_right - p.tan_left);
  const double up_px = p.height_px / (p.tan_top - p.tan_bottom);
  Perspective wider = p;
  wider.width_px = cut_px((extent->right - extent->left) * across_px);
  wider.height_px = whole_px((extent->top - extent->bottom) * up_px);
  // Rounding widens both sides equally, so that pixels keep their size.
  const double middle = 0.5 * (extent->left + extent->right);
  const double half = std::max(0.5 * wider.width_px / across_px, 0.5 * (extent->right - extent->left));
  wider.tan_left = middle - half;
  wider.tan_right = middle + half;
  wider.tan_top = extent->top;
  wider.tan_bottom = std::min(extent->bottom, extent->top - wider.height_px / up_px);
  return wider;
}
PictureShape grown(const Fisheye& p, double guard, double parallax) {
  // Maximum angle by which the turn moves the axis.
  const double moves = 2.0 * std::asin(std::abs(std::cos(p.tilt_rad)) * std::sin(0.5 * std::min(guard, 0.5 * kTurn)));
  const double field = std::min(p.field_rad + 2.0 * (moves + parallax), kTurn);
  const double larger = field / p.field_rad;
  if (!(larger > 1.0)) return p;
  return Fisheye{cut_px(larger * p.width_px), cut_px(larger * p.height_px), field, p.tilt_rad};
}
PictureShape grown(const Equirectangular& p, double, double) { return p; }

double reach(const Panorama& picture, const Panorama& shown) {
  if (is_whole_turn(picture)) return kEndless;
  return std::max(0.0, 0.5 * (picture.azimuth_span_rad - shown.azimuth_span_rad));
}
double reach(const Perspective& picture, const Perspective& shown) {
  if (picture.tilt_rad != shown.tilt_rad) return 0.0;
  return max_turn(0.25 * kTurn, [&](double turn) {
    const auto extent = swept(shown, turn);
    return extent && extent->left >= picture.tan_left - kSameEdge && extent->right <= picture.tan_right + kSameEdge &&
           extent->top <= picture.tan_top + kSameEdge && extent->bottom >= picture.tan_bottom - kSameEdge;
  });
}
double reach(const Fisheye& picture, const Fisheye& shown) {
  if (picture.tilt_rad != shown.tilt_rad) return 0.0;
  if (picture.field_rad >= kTurn) return kEndless;
  const double moves = 0.5 * (picture.field_rad - shown.field_rad);
  const double level = std::abs(std::cos(picture.tilt_rad));
  const double half = std::sin(0.5 * std::max(moves, 0.0)) / std::max(level, 1e-9);
  // At the zenith, a turn does not move the circle.
  if (half >= 1.0 || (level < 1e-9 && moves >= 0.0)) return kEndless;
  return 2.0 * std::asin(half);
}
template <typename A, typename B>
double reach(const A&, const B&) {
  return 0.0;
}

std::optional<PictureShape> joined(const Panorama& a, const Panorama& b) {
  Panorama both;
  both.azimuth_span_rad = std::max(a.azimuth_span_rad, b.azimuth_span_rad);
  both.tan_elevation_top = std::max(a.tan_elevation_top, b.tan_elevation_top);
  both.tan_elevation_bottom = std::min(a.tan_elevation_bottom, b.tan_elevation_bottom);
  const auto rows_per_tan = [](const Panorama& p) {
    return p.height_px / (p.tan_elevation_top - p.tan_elevation_bottom);
  };
  both.width_px = whole_px(both.azimuth_span_rad / std::min(a.radians_per_px(), b.radians_per_px()));
  both.height_px =
      whole_px((both.tan_elevation_top - both.tan_elevation_bottom) * std::max(rows_per_tan(a), rows_per_tan(b)));
  return both;
}
std::optional<PictureShape> joined(const Perspective& a, const Perspective& b) {
  Perspective both = a;
  both.tan_left = std::min(a.tan_left, b.tan_left);
  both.tan_right = std::max(a.tan_right, b.tan_right);
  both.tan_top = std::max(a.tan_top, b.tan_top);
  both.tan_bottom = std::min(a.tan_bottom, b.tan_bottom);
  const auto columns_per_tan = [](const Perspective& p) { return p.width_px / (p.tan_right - p.tan_left); };
  const auto rows_per_tan = [](const Perspective& p) { return p.height_px / (p.tan_top - p.tan_bottom); };
  both.width_px = whole_px((both.tan_right - both.tan_left) * std::max(columns_per_tan(a), columns_per_tan(b)));
  both.height_px = whole_px((both.tan_top - both.tan_bottom) * std::max(rows_per_tan(a), rows_per_tan(b)));
  return both;
}
std::optional<PictureShape> joined(const Fisheye& a, const Fisheye& b) {
  Fisheye both = a;
  both.field_rad = std::max(a.field_rad, b.field_rad);
  both.width_px = both.height_px = whole_px(both.field_rad / std::min(a.radians_per_px(), b.radians_per_px()));
  return both;
}
template <typename A, typename B>
std::optional<PictureShape> joined(const A&, const B&) {
  return std::nullopt;
}

}  // namespace

PictureShape with_guard_band(const PictureShape& shape, double guard_rad, double parallax_rad) {
  const double parallax = std::clamp(parallax_rad, 0.0, 0.25 * kTurn);
  return std::visit([&](const auto& s) { return grown(s, std::max(guard_rad, 0.0), parallax); }, shape);
}

Projection with_guard_band(const Projection& picture, double guard_rad, double parallax_rad) {
  const PictureShape grown = with_guard_band(picture.shape, guard_rad, parallax_rad);
  return {picture.stacked() == 2 ? cut_for_two_eyes(grown) : grown, picture.viewing};
}

double parallax(double moved_m, double distance_m) {
  return moved_m < distance_m ? std::asin(std::max(moved_m, 0.0) / distance_m) : 0.25 * kTurn;
}

PictureShape cut_for_two_eyes(const PictureShape& shape) {
  const int rounded = cells_of_px(height_px(shape)) * kCutPx;
  return with_pixels(shape, width_px(shape), std::min(rounded, kMaxSidePx / 2));
}

double turn_reach(const PictureShape& picture, const PictureShape& shown) {
  return std::visit([](const auto& p, const auto& s) { return reach(p, s); }, picture, shown);
}

std::optional<PictureShape> covering(const PictureShape& a, const PictureShape& b) {
  if (a == b) return a;
  if (!has_same_places(a, b)) return std::nullopt;
  return std::visit([](const auto& p, const auto& q) { return joined(p, q); }, a, b);
}

}  // namespace cyclorama
