// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/museum/true_wall.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/base/check.h"

namespace cyclorama::simulated {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kOnTheEdge = 1e-9;  // Relative to a part's size; rounding must not leave a gap.

double middle_height(const CylinderWall& w) { return 0.5 * (w.bottom_m + w.top_m); }

/// Axes of a dome: right, up, and along its axis.
Eigen::Matrix3d axes_of(const DomeWall& dome) {
  Eigen::Matrix3d axes;
  axes.col(0) = Eigen::Vector3d::UnitX();
  axes.col(2) = dome.axis();
  axes.col(1) = Eigen::Vector3d::UnitX().cross(dome.axis());
  return axes;
}

/// Searches in steps of about two centimetres, for grazing rays, which may hit a nearer bump first.
template <typename Above>
std::optional<double> marched(const Above& above, double farthest) {
  constexpr int kSteps = 400;
  double inside = 0.0;
  if (!(above(inside) > 0.0)) return std::nullopt;
  for (int i = 1; i <= kSteps; ++i) {
    double outside = farthest * i / kSteps;
    if (above(outside) > 0.0) {
      inside = outside;
      continue;
    }
    for (int j = 0; j < 60; ++j) {
      const double middle = 0.5 * (inside + outside);
      (above(middle) > 0.0 ? inside : outside) = middle;
    }
    return inside;
  }
  return std::nullopt;
}

/// Follows a ray to the first point where `above` turns negative; `guess` is its hit on the shape without deviation.
template <typename Above>
std::optional<double> first_crossing(const Above& above, double guess, double farthest, bool is_grazing) {
  if (is_grazing) return marched(above, farthest);
  // Secant method from the shape without deviation; it converges in a few steps.
  double t0 = guess;
  double f0 = above(t0);
  double t1 = t0 + f0;
  for (int i = 0; i < 12; ++i) {
    if (std::abs(f0) < 1e-12) return t0 > 1e-9 ? std::optional(t0) : std::nullopt;
    const double f1 = above(t1);
    const double slope = (f1 - f0) / (t1 - t0);
    t0 = t1;
    f0 = f1;
    if (!(slope < -1e-3) || !std::isfinite(slope)) break;
    t1 = t0 - f0 / slope;
    if (!(t1 > 0.0 && t1 < farthest)) break;
    if (t1 == t0) return t0;
  }
  if (std::abs(f0) < 1e-11) return t0 > 1e-9 ? std::optional(t0) : std::nullopt;
  return marched(above, farthest);
}

}  // namespace

Result<TrueWall> TrueWall::make(Wall shape, const RigidTransform<frame::Room, frame::Room>& T_room_wall,
                                WallDeviation deviation) {
  if (std::holds_alternative<MeshWall>(shape)) {
    return Error(ErrorCode::kInvalidArgument,
                 "a simulated wall cannot be a mesh; take a cylinder, a plane or a dome and add a deviation");
  }
  const auto* planes = std::get_if<PlanesWall>(&shape);
  if (planes != nullptr && planes->rectangles.size() > 1 && !deviation.is_flat()) {
    return Error(ErrorCode::kInvalidArgument,
                 "a deviation on several planes would tear at their edges; leave it out, or take one plane");
  }
  if (planes != nullptr && planes->rectangles.empty())
    return Error(ErrorCode::kInvalidArgument, "a wall of planes needs at least one");
  return TrueWall(std::move(shape), T_room_wall, std::move(deviation));
}

TrueWall::TrueWall(Wall shape, const RigidTransform<frame::Room, frame::Room>& T_room_wall, WallDeviation deviation)
    : shape_(std::move(shape)),
      T_room_wall_(T_room_wall),
      T_wall_room_(T_room_wall.inverse()),
      deviation_(std::move(deviation)) {
  if (deviation_.is_flat()) return;
  constexpr int kSamples = 200;
  for (int j = 0; j <= kSamples; ++j) {
    for (int i = 0; i <= kSamples; ++i) {
      const Surface at =
          surface_of(WallPosition{0, static_cast<double>(i) / kSamples, static_cast<double>(j) / kSamples});
      const WallDeviation::Height height = deviation_.at(at.s_m, at.t_m);
      steepest_ = std::max(steepest_, std::hypot(height.by_s, height.by_t));
    }
  }
}

std::size_t TrueWall::part_count() const {
  const auto* planes = std::get_if<PlanesWall>(&shape_);
  return planes != nullptr ? planes->rectangles.size() : 1;
}

Eigen::Vector2d TrueWall::size_m(std::size_t part) const {
  if (const auto* cylinder = std::get_if<CylinderWall>(&shape_))
    return {cylinder->radius_m * cylinder->arc_rad, cylinder->top_m - cylinder->bottom_m};
  if (const auto* planes = std::get_if<PlanesWall>(&shape_))
    return {planes->rectangles[part].width_m, planes->rectangles[part].height_m};
  const auto& dome = std::get<DomeWall>(shape_);
  const double half = 0.5 * dome.field_rad;
  return {kTurn * dome.radius_m * std::sin(std::min(0.5 * half, 0.25 * kTurn)), dome.radius_m * half};
}

TrueWall::Surface TrueWall::surface_of(const Eigen::Vector3d& point, std::size_t part) const {
  if (const auto* cylinder = std::get_if<CylinderWall>(&shape_)) {
    const double from_axis = std::hypot(point.x() - cylinder->centre_x_m, point.z() - cylinder->centre_z_m);
    return {0, cylinder->radius_m * cylinder->arc_angle_of({point}), point.y() - middle_height(*cylinder),
            cylinder->radius_m - from_axis};
  }
  if (const auto* planes = std::get_if<PlanesWall>(&shape_)) {
    const WallRectangle& r = planes->rectangles[part];
    const Eigen::Vector3d from_middle = point - r.middle.xyz;
    return {part, r.right.dot(from_middle), r.up.dot(from_middle), r.normal().dot(from_middle)};
  }
  const auto& dome = std::get<DomeWall>(shape_);
  const Eigen::Vector3d out = axes_of(dome).transpose() * (point - dome.centre.xyz);
  const double sideways = std::hypot(out.x(), out.y());
  const double arc = dome.radius_m * std::atan2(sideways, out.z());
  const double scale = sideways > 0.0 ? arc / sideways : 0.0;
  return {0, scale * out.x(), scale * out.y(), dome.radius_m - out.norm()};
}

Eigen::Vector3d TrueWall::point_of(const Surface& at) const {
  const double height = deviation_.is_flat() ? 0.0 : deviation_.at(at.s_m, at.t_m).m;
  if (const auto* cylinder = std::get_if<CylinderWall>(&shape_)) {
    CylinderWall standing_out = *cylinder;
    standing_out.radius_m -= height;
    return standing_out.point_at(at.s_m / cylinder->radius_m, at.t_m + middle_height(*cylinder)).xyz;
  }
  if (const auto* planes = std::get_if<PlanesWall>(&shape_)) {
    const WallRectangle& r = planes->rectangles[at.part];
    return r.middle.xyz + at.s_m * r.right + at.t_m * r.up + height * r.normal();
  }
  DomeWall dome = std::get<DomeWall>(shape_);
  const double from_axis = std::hypot(at.s_m, at.t_m) / dome.radius_m;
  dome.radius_m -= height;
  return dome.point_at(from_axis, std::atan2(at.t_m, at.s_m)).xyz;
}

Eigen::Vector3d TrueWall::normal_of(const Surface& at) const {
  const WallDeviation::Height h = deviation_.is_flat() ? WallDeviation::Height{} : deviation_.at(at.s_m, at.t_m);
  if (const auto* cylinder = std::get_if<CylinderWall>(&shape_)) {
    const double arc_angle = at.s_m / cylinder->radius_m;
    const Eigen::Vector3d inwards(-std::sin(arc_angle), 0.0, std::cos(arc_angle));
    const Eigen::Vector3d right(std::cos(arc_angle), 0.0, std::sin(arc_angle));
    const double shrunk = 1.0 - h.m / cylinder->radius_m;
    return (shrunk * inwards - h.by_s * right - shrunk * h.by_t * Eigen::Vector3d::UnitY()).normalized();
  }
  if (const auto* planes = std::get_if<PlanesWall>(&shape_)) {
    const WallRectangle& r = planes->rectangles[at.part];
    return (r.normal() - h.by_s * r.right - h.by_t * r.up).normalized();
  }
  const auto& dome = std::get<DomeWall>(shape_);
  const Eigen::Vector3d point = point_of(at);
  if (deviation_.is_flat()) return (dome.centre.xyz - point).normalized();
  // A dome's coordinates stretch away from the axis, so slopes are computed from the points themselves.
  constexpr double kStep_m = 1e-5;
  const auto moved = [&](double s, double t) { return point_of({0, at.s_m + s, at.t_m + t, 0.0}); };
  const Eigen::Vector3d along_s = moved(kStep_m, 0.0) - moved(-kStep_m, 0.0);
  const Eigen::Vector3d along_t = moved(0.0, kStep_m) - moved(0.0, -kStep_m);
  const Eigen::Vector3d normal = along_s.cross(along_t).normalized();
  return normal.dot(dome.centre.xyz - point) > 0.0 ? normal : Eigen::Vector3d(-normal);
}

std::optional<WallPosition> TrueWall::place_of(const Surface& at) const {
  WallPosition position{at.part, 0.0, 0.0};
  if (const auto* dome = std::get_if<DomeWall>(&shape_)) {
    position.across = std::atan2(at.t_m, at.s_m) / kTurn;
    if (position.across < 0.0) position.across += 1.0;
    const double whole = 1.0 - std::cos(0.5 * dome->field_rad);
    position.along = (1.0 - std::cos(std::hypot(at.s_m, at.t_m) / dome->radius_m)) / whole;
  } else {
    const Eigen::Vector2d size = size_m(at.part);
    position.across = at.s_m / size.x() + 0.5;
    position.along = at.t_m / size.y() + 0.5;
  }
  const auto is_inside = [](double x) { return x >= -kOnTheEdge && x <= 1.0 + kOnTheEdge; };
  if (!is_inside(position.across) || !is_inside(position.along)) return std::nullopt;
  return position;
}

TrueWall::Surface TrueWall::surface_of(const WallPosition& position) const {
  if (const auto* dome = std::get_if<DomeWall>(&shape_)) {
    const double whole = 1.0 - std::cos(0.5 * dome->field_rad);
    const double arc = dome->radius_m * std::acos(std::clamp(1.0 - position.along * whole, -1.0, 1.0));
    return {0, arc * std::cos(kTurn * position.across), arc * std::sin(kTurn * position.across), 0.0};
  }
  const Eigen::Vector2d size = size_m(position.part);
  return {position.part, (position.across - 0.5) * size.x(), (position.along - 0.5) * size.y(), 0.0};
}

std::optional<Eigen::Vector3d> TrueWall::meet(const RoomRay& ray, std::size_t part) const {
  const RoomRay unit{ray.origin, ray.direction.normalized()};
  std::optional<Point<frame::Room>> guess;
  if (const auto* planes = std::get_if<PlanesWall>(&shape_)) {
    const PlanesWall one{{planes->rectangles[part]}};
    guess = deviation_.is_flat() ? one.hit(unit) : one.hit_extended(unit);
  } else {
    guess = deviation_.is_flat() ? cyclorama::hit(shape_, unit) : cyclorama::hit_extended(shape_, unit);
  }
  if (!guess) return std::nullopt;
  if (deviation_.is_flat()) return guess->xyz;
  const auto above = [&](double t) {
    const Surface at = surface_of(Eigen::Vector3d(unit.origin.xyz + t * unit.direction), part);
    return at.above_m - deviation_.at(at.s_m, at.t_m).m;
  };
  const double straight = (guess->xyz - unit.origin.xyz).dot(unit.direction);
  constexpr double kStep_m = 1e-4;
  const Eigen::Vector3d before = guess->xyz - kStep_m * unit.direction;
  const double steepness = surface_of(before, part).above_m / kStep_m;
  const bool is_grazing = steepness < 1.2 * steepest_ + 0.02;
  const auto t = first_crossing(above, straight, straight + 20.0 * deviation_.bound_m() + 0.1, is_grazing);
  if (!t) return std::nullopt;
  return unit.origin.xyz + *t * unit.direction;
}

TrueWall::Hit TrueWall::made(const Surface& surface, const Eigen::Vector3d& point, const WallPosition& position) const {
  return {T_room_wall_ * Point<frame::Room>{point}, T_room_wall_.rotation() * normal_of(surface), position};
}

std::optional<TrueWall::Hit> TrueWall::hit(const RoomRay& ray) const {
  const RoomRay inner{T_wall_room_ * ray.origin, T_wall_room_.rotation() * ray.direction};
  std::optional<Hit> first;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t part = 0; part < part_count(); ++part) {
    const auto point = meet(inner, part);
    if (!point) continue;
    const double distance = (*point - inner.origin.xyz).norm();
    if (!(distance < nearest)) continue;
    const Surface surface = surface_of(*point, part);
    const auto position = place_of(surface);
    if (!position) continue;
    nearest = distance;
    first = made(surface, *point, *position);
  }
  return first;
}

bool TrueWall::is_reached(const Hit& at, const Point<frame::Room>& source) const {
  if (!((source.xyz - at.point.xyz).dot(at.normal) > 0.0)) return false;
  return cyclorama::is_reached(shape_, T_wall_room_ * at.point, T_wall_room_ * source);
}

TrueWall::Hit TrueWall::at(const WallPosition& position) const {
  CHECK(position.part < part_count());
  const Surface surface = surface_of(position);
  return made(surface, point_of(surface), position);
}

double TrueWall::area_m2(const WallPosition& low, const WallPosition& high) const {
  const double across = high.across - low.across;
  const double along = high.along - low.along;
  if (deviation_.is_flat()) {
    if (const auto* dome = std::get_if<DomeWall>(&shape_)) {
      const double whole = kTurn * dome->radius_m * dome->radius_m * (1.0 - std::cos(0.5 * dome->field_rad));
      return whole * across * along;
    }
    return size_m(low.part).prod() * across * along;
  }
  // Uses central differences, since cells are small compared to the deviation's features.
  const auto middle = [&](double a, double b) {
    return at({low.part, low.across + a * across, low.along + b * along}).point.xyz;
  };
  const Eigen::Vector3d wide = middle(1.0, 0.5) - middle(0.0, 0.5);
  const Eigen::Vector3d high_side = middle(0.5, 1.0) - middle(0.5, 0.0);
  return wide.cross(high_side).norm();
}

}  // namespace cyclorama::simulated
