// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/navigation/walkable_area.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace cyclorama {
namespace {

using Eigen::Vector2d;

constexpr double kLargestMarginM = 0.01;
constexpr double kMarginBySize = 5e-4;
constexpr double kSlack = 1e-3;  // Fraction of the margin by which a push overshoots, so that rounding never matters.
constexpr double kFarthestM = 1e7;
constexpr int kPushes = 4;  // Covers two edges that meet, and a repetition for what the second push undid.
// A step that cannot be taken whole is halved at least kFewestHalvings times, and down to this fraction of the margin.
constexpr double kShortest = 0.125;
constexpr int kFewestHalvings = 3;
constexpr int kMostPieces = 32;
constexpr int kRingPlaces = 48;

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Touching counts as crossing.
bool segments_cross(const Vector2d& p, const Vector2d& q, const Vector2d& a, const Vector2d& b) {
  const Vector2d way = q - p;
  const Vector2d edge = b - a;
  const double side_a = cross(way, a - p);
  const double side_b = cross(way, b - p);
  const double side_p = cross(edge, p - a);
  const double side_q = cross(edge, q - a);
  if (side_a * side_b > 0.0 || side_p * side_q > 0.0) return false;
  if (side_a != 0.0 || side_b != 0.0) return true;
  // Collinear segments cross when their extents overlap.
  return std::max(std::min(p.x(), q.x()), std::min(a.x(), b.x())) <=
             std::min(std::max(p.x(), q.x()), std::max(a.x(), b.x())) &&
         std::max(std::min(p.y(), q.y()), std::min(a.y(), b.y())) <=
             std::min(std::max(p.y(), q.y()), std::max(a.y(), b.y()));
}

}  // namespace

Vector2d WalkableArea::Edge::nearest_to(const Vector2d& place) const {
  const Vector2d edge = b - a;
  const double length2 = edge.squaredNorm();
  const double t = length2 > 0.0 ? std::clamp((place - a).dot(edge) / length2, 0.0, 1.0) : 0.0;
  return a + t * edge;
}

void WalkableArea::add(const std::vector<Vector2d>& polygon) {
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    corners_.push_back(polygon[i]);
    edges_.push_back({polygon[j], polygon[i]});
  }
  polygon_ends_.push_back(edges_.size());
}

std::vector<std::vector<Vector2d>> WalkableArea::polygons() const {
  std::vector<std::vector<Vector2d>> polygons;
  std::size_t begin = 0;
  for (const std::size_t end : polygon_ends_) {
    polygons.emplace_back(corners_.begin() + static_cast<std::ptrdiff_t>(begin),
                          corners_.begin() + static_cast<std::ptrdiff_t>(end));
    begin = end;
  }
  return polygons;
}

Result<WalkableArea> WalkableArea::make(std::vector<Vector2d> corners,
                                        const std::vector<std::vector<Vector2d>>& holes) {
  WalkableArea area;
  area.add(corners);
  bool are_polygons = corners.size() >= 3;
  for (const std::vector<Vector2d>& hole : holes) {
    are_polygons = are_polygons && hole.size() >= 3;
    if (area.corners_.size() <= kMostCorners) area.add(hole);
  }
  if (!are_polygons || area.corners_.size() > kMostCorners) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("the walkable area has {} corners, and {} holes; it needs 3 to {}, and 3 for each hole",
                             area.corners_.size(), holes.size(), kMostCorners));
  }
  Vector2d least = corners.front();
  Vector2d most = corners.front();
  for (const Vector2d& corner : area.corners_) {
    if (!(corner.cwiseAbs().maxCoeff() <= kFarthestM) || !corner.allFinite()) {
      return Error(ErrorCode::kInvalidArgument,
                   fmt::format("the walkable area has a corner at ({}, {})", corner.x(), corner.y()));
    }
    least = least.cwiseMin(corner);
    most = most.cwiseMax(corner);
  }
  area.size_m_ = (most - least).norm();
  area.margin_m_ = std::min(kLargestMarginM, kMarginBySize * area.size_m_);
  for (int attempt = 0; attempt < 3 && area.margin_m_ > 0.0; ++attempt, area.margin_m_ /= 10.0) {
    if (area.find_some_place()) return area;
  }
  return Error(ErrorCode::kInvalidArgument, "the walkable area leaves no room to stand; is it folded to a line?");
}

bool WalkableArea::is_within(const Vector2d& place, std::size_t first_edge, std::size_t end_edge) const {
  bool inside = false;
  for (std::size_t i = first_edge; i < end_edge; ++i) {
    const Vector2d& a = edges_[i].b;
    const Vector2d& b = edges_[i].a;
    if ((a.y() > place.y()) == (b.y() > place.y())) continue;
    if (place.x() < (b.x() - a.x()) * (place.y() - a.y()) / (b.y() - a.y()) + a.x()) inside = !inside;
  }
  return inside;
}

bool WalkableArea::contains(const Vector2d& place) const {
  if (!is_within(place, 0, polygon_ends_.front())) return false;
  for (std::size_t hole = 1; hole < polygon_ends_.size(); ++hole) {
    if (is_within(place, polygon_ends_[hole - 1], polygon_ends_[hole])) return false;
  }
  return true;
}

WalkableArea::Contact WalkableArea::nearest_edge(const Vector2d& place) const {
  Contact nearest{corners_.front(), std::numeric_limits<double>::infinity()};
  for (const Edge& edge : edges_) {
    const Vector2d point = edge.nearest_to(place);
    const double distance = (place - point).norm();
    if (distance < nearest.distance) nearest = {point, distance};
  }
  return nearest;
}

bool WalkableArea::allows(const Vector2d& place) const {
  return place.allFinite() && nearest_edge(place).distance >= margin_m_ && contains(place);
}

bool WalkableArea::sees(const Vector2d& from, const Vector2d& to) const {
  for (const Edge& edge : edges_) {
    if (segments_cross(from, to, edge.a, edge.b)) return false;
  }
  return true;
}

Vector2d WalkableArea::pushed_inside(Vector2d place) const {
  for (int push = 0; push < kPushes; ++push) {
    const Contact contact = nearest_edge(place);
    const bool inside = contains(place);
    if (inside && contact.distance >= margin_m_) break;
    if (contact.distance == 0.0) break;  // On the edge there is no direction to go; the caller tries a shorter step.
    const Vector2d outwards = (contact.point - place) / contact.distance;
    const double distance = (1.0 + kSlack) * margin_m_;
    place = contact.point + (inside ? -distance : distance) * outwards;
  }
  return place;
}

Vector2d WalkableArea::walk(const Vector2d& from, const Vector2d& step) const {
  CHECK(allows(from));
  if (!step.allFinite() || step.isZero(0.0)) return from;
  // Walks in small pieces, so that only the part of the step after the contact slides along an edge.
  const double length = std::min(step.norm(), size_m_);
  const double pieces = std::clamp(std::ceil(length / (4.0 * margin_m_)), 1.0, double{kMostPieces});
  const Vector2d piece = step.normalized() * (length / pieces);
  Vector2d place = from;
  for (int i = 0; i < static_cast<int>(pieces); ++i) {
    bool moved = false;
    Vector2d part = piece;
    for (int halving = 0; halving < kFewestHalvings || part.norm() > kShortest * margin_m_; ++halving, part /= 2.0) {
      const Vector2d next = pushed_inside(place + part);
      const bool is_short = (next - place).norm() <= part.norm() + 2.0 * kSlack * margin_m_;
      if (!is_short || !allows(next) || !sees(place, next)) continue;
      place = next;
      moved = true;
      break;
    }
    if (!moved) break;  // In a corner nothing of this direction can be walked.
  }
  return place;
}

bool WalkableArea::find_place_near(const Vector2d& place, Vector2d* ret_found) const {
  for (double radius = 1.01 * margin_m_; radius < 2.0 * size_m_; radius *= 1.5) {
    for (int i = 0; i < kRingPlaces; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kRingPlaces;
      const Vector2d candidate = place + radius * Vector2d(std::cos(angle), std::sin(angle));
      if (!allows(candidate)) continue;
      *ret_found = candidate;
      return true;
    }
  }
  return false;
}

bool WalkableArea::find_some_place() {
  // Searches beside the edges, at growing distances along their normals: few tests, since a hostile polygon has no such
  // position.
  for (const Edge& beside : edges_) {
    const Vector2d edge = beside.b - beside.a;
    if (edge.norm() <= 0.0) continue;
    const Vector2d normal = Vector2d(-edge.y(), edge.x()).normalized();
    for (const double along : {0.5, 0.2, 0.8}) {
      for (double distance = 1.01 * margin_m_; distance < size_m_; distance *= 2.0) {
        for (const double side : {distance, -distance}) {
          some_place_ = beside.a + along * edge + side * normal;
          if (allows(some_place_)) return true;
        }
      }
    }
  }
  return false;
}

Vector2d WalkableArea::nearest_allowed(const Vector2d& place) const {
  if (!place.allFinite() || place.cwiseAbs().maxCoeff() > 100.0 * kFarthestM) return some_place_;
  if (allows(place)) return place;
  const Vector2d pushed = pushed_inside(place);
  if (allows(pushed)) return pushed;
  Vector2d found = some_place_;
  return find_place_near(nearest_edge(place).point, &found) ? found : some_place_;
}

}  // namespace cyclorama
