// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/trust/view_guard.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cyclorama::trust {
namespace {

using Point = std::array<double, 2>;
using Polygon = std::vector<Point>;

double distance(const Point& a, const Point& b) { return std::hypot(a[0] - b[0], a[1] - b[1]); }

bool is_inside(const Polygon& polygon, const Point& at) {
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Point& a = polygon[i];
    const Point& b = polygon[j];
    if ((a[1] > at[1]) == (b[1] > at[1])) continue;
    if (at[0] < (b[0] - a[0]) * (at[1] - a[1]) / (b[1] - a[1]) + a[0]) inside = !inside;
  }
  return inside;
}

double distance_to_edge(const Polygon& polygon, const Point& at) {
  double least = INFINITY;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Point& a = polygon[j];
    const Point edge{polygon[i][0] - a[0], polygon[i][1] - a[1]};
    const double squared = edge[0] * edge[0] + edge[1] * edge[1];
    const double along = squared > 0.0 ? ((at[0] - a[0]) * edge[0] + (at[1] - a[1]) * edge[1]) / squared : 0.0;
    const double t = std::clamp(along, 0.0, 1.0);
    least = std::min(least, distance(at, {a[0] + t * edge[0], a[1] + t * edge[1]}));
  }
  return least;
}

/// Returns the pixels per radian straight ahead, or at the direction of the picture that is closest to straight ahead.
double px_per_rad(const wire::Panorama& picture) {
  constexpr double kMinAngle = 1e-9;
  const auto width = static_cast<double>(picture.width_px());
  switch (picture.projection()) {
    case wire::Panorama::PERSPECTIVE: {
      const bool is_ahead = picture.tan_left() <= 0.0 && picture.tan_right() >= 0.0;
      const double tangent = is_ahead ? 0.0 : std::min(std::abs(picture.tan_left()), std::abs(picture.tan_right()));
      return width * (1.0 + tangent * tangent) /
             std::max(kMinAngle, std::abs(picture.tan_right() - picture.tan_left()));
    }
    case wire::Panorama::FISHEYE:
      return width / std::max(kMinAngle, picture.field_rad());
    default:
      return width / std::max(kMinAngle, picture.azimuth_span_rad());
  }
}

Error refuse(const std::string& what) { return Error(ErrorCode::kInvalidArgument, what); }

}  // namespace

ViewGuard::ViewGuard(const wire::SceneDescription& scene)
    : min_height_m_(scene.start_eye_m().y()),
      max_height_m_(scene.start_eye_m().y()),
      scale_(std::isfinite(scene.walking_scale()) ? std::max(1.0, scene.walking_scale()) : 1.0),
      pace_(scale_ * kPaceMPerS, scale_ * kPaceReserveM) {
  for (const wire::GroundPoint& corner : scene.walkable()) area_.push_back({corner.x_m(), corner.z_m()});
  for (const wire::GroundPolygon& polygon : scene.walkable_holes()) {
    Polygon& hole = holes_.emplace_back();
    for (const wire::GroundPoint& corner : polygon.corners()) hole.push_back({corner.x_m(), corner.z_m()});
  }
  jumps_.push_back({scene.start_eye_m().x(), scene.start_eye_m().z()});
  for (const wire::TourStop& stop : scene.stops()) {
    jumps_.push_back({stop.eye_m().x(), stop.eye_m().z()});
    min_height_m_ = std::min(min_height_m_, stop.eye_m().y());
    max_height_m_ = std::max(max_height_m_, stop.eye_m().y());
  }
}

bool ViewGuard::is_walkable(const Point& eye) const {
  constexpr std::size_t kMinCorners = 3;
  if (std::ranges::any_of(jumps_, [&](const Point& jump) { return distance(eye, jump) <= kMarginM; })) return true;
  if (area_.size() < kMinCorners) return true;
  if (!is_inside(area_, eye) && distance_to_edge(area_, eye) > kMarginM) return false;
  return std::ranges::none_of(holes_, [&](const Polygon& hole) {
    return hole.size() >= kMinCorners && is_inside(hole, eye) && distance_to_edge(hole, eye) > kMarginM;
  });
}

Status ViewGuard::check(const wire::View& view, TimePoint now) {
  const Point eye{view.eye_m().x(), view.eye_m().z()};
  const double height = view.eye_m().y();
  if (!is_walkable(eye)) {
    return refuse(
        fmt::format("view.eye_m ({:.2f}, {:.2f}, {:.2f}) is outside the walkable area", eye[0], height, eye[1]));
  }
  if (!(height >= min_height_m_ - kHeightM && height <= max_height_m_ + kHeightM)) {
    return refuse(fmt::format("view.eye_m.y is {:.2f}; visitors' eyes are from {:.2f} to {:.2f}", height,
                              min_height_m_ - kHeightM, max_height_m_ + kHeightM));
  }
  if (view.panorama().has_eyes() && view.panorama().eyes().distance_m() > kMaxEyeDistanceM) {
    return refuse(fmt::format("view.panorama.eyes.distance_m is {}; this farm allows at most {}",
                              view.panorama().eyes().distance_m(), kMaxEyeDistanceM));
  }
  if (const double fine = px_per_rad(view.panorama()); fine > kMaxPxPerRad) {
    return refuse(
        fmt::format("view.panorama has {:.0f} pixels per radian; this farm allows at most {:.0f}", fine, kMaxPxPerRad));
  }
  const bool is_jump = std::ranges::any_of(jumps_, [&](const Point& jump) { return distance(eye, jump) <= kMarginM; });
  const double walked = has_moved_ ? std::min(distance(eye, last_), scale_ * kPaceReserveM) : 0.0;
  has_moved_ = true;
  last_ = eye;
  if (is_jump || pace_.take(walked, now) <= now) return Done{};
  return refuse(fmt::format("view.eye_m moves faster than {:.1f} m/s", scale_ * kPaceMPerS));
}

Status DailyViews::count(const std::string& scene, const wire::View& view, const Limits& limits, std::int64_t day) {
  if (day != day_) *this = DailyViews();
  day_ = day;
  if (limits.views > 0 && views_ >= limits.views) {
    return Error(ErrorCode::kBusy, fmt::format("the museum has had its {} views of today", limits.views));
  }
  ++views_;
  if (limits.places <= 0) return Done{};
  const auto square = [](double metres) { return static_cast<std::int64_t>(std::floor(metres / kPlaceM)); };
  const auto place = std::pair(scene, std::array{square(view.eye_m().x()), square(view.eye_m().z())});
  if (places_.contains(place)) return Done{};
  if (static_cast<std::int64_t>(places_.size()) >= limits.places) {
    return Error(ErrorCode::kBusy, fmt::format("the museum has seen its {} places of today", limits.places));
  }
  places_.insert(place);
  return Done{};
}

}  // namespace cyclorama::trust
