// SPDX-License-Identifier: Apache-2.0
// Choice of the picture that covers a wall.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/geometry/guard_band.h"
#include "common/geometry/picture_place.h"
#include "common/room/installation.h"

namespace cyclorama {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kTurn = 2.0 * std::numbers::pi;
// The limit of validate(); a very narrow and high wall gets pixels that are not square.
constexpr int kMaxSidePx = 16384;
/// Tolerance in radians within which a wall counts as a full turn, since its outline is known only at points.
constexpr double kSlit = 0.1;
/// Tangent of 75 degrees, where a pixel of a flat picture covers a fifteenth of the angle that a pixel in the middle
/// covers.
constexpr double kSteepest = 3.732;
constexpr double kNearest_m = 1e-3;
/// Pixels beyond the edge of a fisheye's circle, needed for interpolation at the edge.
constexpr double kFisheyeMargin_px = 1.5;

/// Returns the directions from the eye to the wall's outline.
std::vector<Eigen::Vector3d> directions_of(const Installation& room) {
  std::vector<Eigen::Vector3d> directions;
  for (const Point<frame::Room>& point : outline(room.wall)) directions.push_back(point.xyz - room.sweet_spot.xyz);
  return directions;
}

int rows(double px) { return static_cast<int>(std::clamp(std::round(px), 1.0, double{kMaxSidePx})); }

/// Returns the picture on the plane; empty if the plane extends too far to the side.
std::optional<Perspective> perspective_of(const WallRectangle& plane, const std::vector<Eigen::Vector3d>& directions,
                                          int width_px) {
  Perspective picture;
  picture.width_px = width_px;
  picture.tilt_rad = std::asin(std::clamp(-plane.normal().y(), -1.0, 1.0));
  picture.tan_left = picture.tan_bottom = std::numeric_limits<double>::infinity();
  picture.tan_right = picture.tan_top = -std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& direction : directions) {
    const auto place = place_of(picture, direction);
    if (!place || !(std::max(std::abs(place->across), std::abs(place->up)) <= kSteepest)) return std::nullopt;
    picture.tan_left = std::min(picture.tan_left, place->across);
    picture.tan_right = std::max(picture.tan_right, place->across);
    picture.tan_bottom = std::min(picture.tan_bottom, place->up);
    picture.tan_top = std::max(picture.tan_top, place->up);
  }
  const double per_px = (picture.tan_right - picture.tan_left) / width_px;
  picture.height_px = rows((picture.tan_top - picture.tan_bottom) / per_px);
  return picture;
}

/// Returns the largest angle between a direction and an axis tilted by `tilt_rad`.
double widest_from(double tilt_rad, const std::vector<Eigen::Vector3d>& directions) {
  const Eigen::Vector3d axis(0.0, std::sin(tilt_rad), -std::cos(tilt_rad));
  double widest = 0.0;
  for (const Eigen::Vector3d& d : directions) widest = std::max(widest, std::atan2(d.cross(axis).norm(), d.dot(axis)));
  return widest;
}

double best_tilt(const std::vector<Eigen::Vector3d>& directions) {
  double best = 0.0;
  double min = widest_from(best, directions);
  for (int degrees = -90; degrees <= 90; ++degrees) {
    const double widest = widest_from(degrees * kDegree, directions);
    if (widest < min - 1e-9) {
      min = widest;
      best = degrees * kDegree;
    }
  }
  return best;
}

Fisheye fisheye_of(double tilt_rad, const std::vector<Eigen::Vector3d>& directions, int width_px, int height_px) {
  Fisheye picture{width_px, height_px > 0 ? height_px : width_px, 0.0, tilt_rad};
  const double shown = std::max(0.25, 1.0 - kFisheyeMargin_px / picture.radius_px());
  picture.field_rad = std::min(2.0 * widest_from(tilt_rad, directions) / shown, kTurn);
  return picture;
}

}  // namespace

Panorama Installation::panorama(int width_px) const {
  double widest = 0.0;
  double top = -std::numeric_limits<double>::infinity();
  double bottom = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& d : directions_of(*this)) {
    widest = std::max(widest, std::abs(std::atan2(d.x(), -d.z())));
    const double tan_elevation = d.y() / std::hypot(d.x(), d.z());
    top = std::max(top, tan_elevation);
    bottom = std::min(bottom, tan_elevation);
  }
  Panorama panorama;
  panorama.width_px = width_px;
  const bool closes = 2.0 * widest > kTurn - kSlit && !std::holds_alternative<CylinderWall>(wall);
  panorama.azimuth_span_rad = closes ? kTurn : std::min(2.0 * widest, kTurn);
  panorama.tan_elevation_top = top;
  panorama.tan_elevation_bottom = bottom;
  panorama.height_px = rows((top - bottom) / panorama.radians_per_px());
  return panorama;
}

PictureShape Installation::picture(int width_px, int height_px) const {
  const std::vector<Eigen::Vector3d> directions = directions_of(*this);
  if (const auto* dome = std::get_if<DomeWall>(&wall)) {
    return fisheye_of(dome->tilt_rad, directions, width_px, height_px);
  }
  if (const auto* planes = std::get_if<PlanesWall>(&wall); planes != nullptr && planes->rectangles.size() == 1) {
    if (auto flat = perspective_of(planes->rectangles.front(), directions, width_px)) {
      if (height_px > 0) flat->height_px = height_px;
      return *flat;
    }
  }
  Panorama round = panorama(width_px);
  if (!(round.tan_elevation_top <= kSteepest && round.tan_elevation_bottom >= -kSteepest)) {
    return fisheye_of(best_tilt(directions), directions, width_px, height_px);
  }
  if (height_px > 0) round.height_px = height_px;
  return round;
}

double Installation::screen_distance_m(const PictureShape& picture) const {
  const Eigen::Vector3d axis = direction_of(picture, {});
  double inverse_distance = 0.0;
  std::size_t count = 0;
  for (const Eigen::Vector3d& d : directions_of(*this)) {
    const double distance = std::holds_alternative<Panorama>(picture)      ? std::hypot(d.x(), d.z())
                            : std::holds_alternative<Perspective>(picture) ? d.dot(axis)
                                                                           : d.norm();
    inverse_distance += 1.0 / std::max(distance, kNearest_m);
    ++count;
  }
  return static_cast<double>(count) / inverse_distance;
}

Projection Installation::projection(int width_px, int height_px) const {
  PictureShape shape = picture(width_px, height_px);
  if (!stereo) return {shape, {}};
  shape = cut_for_two_eyes(shape);
  Viewing viewing;
  viewing.eyes = Eyes::kOverUnder;
  viewing.eye_distance_m = stereo->eye_distance_m;
  viewing.screen_distance_m = screen_distance_m(shape);
  return {shape, viewing};
}

}  // namespace cyclorama
