// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/navigation/walkable_area.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace cyclorama::tour {
namespace {

using Eigen::Vector2d;

constexpr double kMaxMarginM = 0.01;
constexpr double kMarginBySize = 5e-4;
constexpr double kSlack = 1e-3;  // Fraction of the margin by which a correction overshoots, against rounding.
constexpr double kMaxCoordinateM = 1e7;
// Enough for two edges that meet, each twice, since moving away from one may move back across the other.
constexpr int kDisplacements = 4;
// A step that cannot be taken whole is halved at least kMinHalvings times, and down to this fraction of the margin.
constexpr double kMinStepShare = 0.125;
constexpr int kMinHalvings = 3;
constexpr int kMaxPieces = 32;
constexpr int kRingPositions = 48;

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// True if the segments pq and ab cross or touch.
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

Vector2d WalkableArea::Edge::nearest_to(const Vector2d& position) const {
  const Vector2d edge = b - a;
  const double length2 = edge.squaredNorm();
  const double t = length2 > 0.0 ? std::clamp((position - a).dot(edge) / length2, 0.0, 1.0) : 0.0;
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
    if (area.corners_.size() <= kMaxCorners) area.add(hole);
  }
  if (!are_polygons || area.corners_.size() > kMaxCorners) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("the walkable area has {} corners, and {} holes; it needs 3 to {}, and 3 for each hole",
                             area.corners_.size(), holes.size(), kMaxCorners));
  }
  Vector2d min = corners.front();
  Vector2d max = corners.front();
  for (const Vector2d& corner : area.corners_) {
    if (!(corner.cwiseAbs().maxCoeff() <= kMaxCoordinateM) || !corner.allFinite()) {
      return Error(ErrorCode::kInvalidArgument,
                   fmt::format("the walkable area has a corner at ({}, {})", corner.x(), corner.y()));
    }
    min = min.cwiseMin(corner);
    max = max.cwiseMax(corner);
  }
  area.size_m_ = (max - min).norm();
  area.margin_m_ = std::min(kMaxMarginM, kMarginBySize * area.size_m_);
  for (int attempt = 0; attempt < 3 && area.margin_m_ > 0.0; ++attempt, area.margin_m_ /= 10.0) {
    if (area.find_any_position()) return area;
  }
  return Error(ErrorCode::kInvalidArgument, "the walkable area leaves no room to stand; is it folded to a line?");
}

bool WalkableArea::is_within(const Vector2d& position, std::size_t first_edge, std::size_t end_edge) const {
  bool inside = false;
  for (std::size_t i = first_edge; i < end_edge; ++i) {
    const Vector2d& a = edges_[i].b;
    const Vector2d& b = edges_[i].a;
    if ((a.y() > position.y()) == (b.y() > position.y())) continue;
    if (position.x() < (b.x() - a.x()) * (position.y() - a.y()) / (b.y() - a.y()) + a.x()) inside = !inside;
  }
  return inside;
}

bool WalkableArea::contains(const Vector2d& position) const {
  if (!is_within(position, 0, polygon_ends_.front())) return false;
  for (std::size_t hole = 1; hole < polygon_ends_.size(); ++hole) {
    if (is_within(position, polygon_ends_[hole - 1], polygon_ends_[hole])) return false;
  }
  return true;
}

WalkableArea::Contact WalkableArea::nearest_edge(const Vector2d& position) const {
  Contact nearest{corners_.front(), std::numeric_limits<double>::infinity()};
  for (const Edge& edge : edges_) {
    const Vector2d point = edge.nearest_to(position);
    const double distance = (position - point).norm();
    if (distance < nearest.distance) nearest = {point, distance};
  }
  return nearest;
}

bool WalkableArea::allows(const Vector2d& position) const {
  return position.allFinite() && nearest_edge(position).distance >= margin_m_ && contains(position);
}

bool WalkableArea::sees(const Vector2d& from, const Vector2d& to) const {
  for (const Edge& edge : edges_) {
    if (segments_cross(from, to, edge.a, edge.b)) return false;
  }
  return true;
}

Vector2d WalkableArea::moved_inside(Vector2d position) const {
  for (int push = 0; push < kDisplacements; ++push) {
    const Contact contact = nearest_edge(position);
    const bool inside = contains(position);
    if (inside && contact.distance >= margin_m_) break;
    if (contact.distance == 0.0) break;  // On the edge there is no direction to go; the caller tries a shorter step.
    const Vector2d outwards = (contact.point - position) / contact.distance;
    const double distance = (1.0 + kSlack) * margin_m_;
    position = contact.point + (inside ? -distance : distance) * outwards;
  }
  return position;
}

Vector2d WalkableArea::walk(const Vector2d& from, const Vector2d& step) const {
  CHECK(allows(from));
  if (!step.allFinite() || step.isZero(0.0)) return from;
  // Walks in small pieces, so that only the part of the step after the contact slides along an edge.
  const double length = std::min(step.norm(), size_m_);
  const double pieces = std::clamp(std::ceil(length / (4.0 * margin_m_)), 1.0, double{kMaxPieces});
  const Vector2d piece = step.normalized() * (length / pieces);
  Vector2d position = from;
  for (int i = 0; i < static_cast<int>(pieces); ++i) {
    bool moved = false;
    Vector2d part = piece;
    for (int halving = 0; halving < kMinHalvings || part.norm() > kMinStepShare * margin_m_; ++halving, part /= 2.0) {
      const Vector2d next = moved_inside(position + part);
      const bool is_short = (next - position).norm() <= part.norm() + 2.0 * kSlack * margin_m_;
      if (!is_short || !allows(next) || !sees(position, next)) continue;
      position = next;
      moved = true;
      break;
    }
    if (!moved) break;  // In a corner, no part of the step can be walked.
  }
  return position;
}

bool WalkableArea::find_position_near(const Vector2d& position, Vector2d* ret_found) const {
  for (double radius = 1.01 * margin_m_; radius < 2.0 * size_m_; radius *= 1.5) {
    for (int i = 0; i < kRingPositions; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kRingPositions;
      const Vector2d candidate = position + radius * Vector2d(std::cos(angle), std::sin(angle));
      if (!allows(candidate)) continue;
      *ret_found = candidate;
      return true;
    }
  }
  return false;
}

bool WalkableArea::find_any_position() {
  // Searches beside the edges, at growing distances along their normals. The number of tests is limited, since a
  // malicious polygon may have no such position.
  for (const Edge& beside : edges_) {
    const Vector2d edge = beside.b - beside.a;
    if (edge.norm() <= 0.0) continue;
    const Vector2d normal = Vector2d(-edge.y(), edge.x()).normalized();
    for (const double along : {0.5, 0.2, 0.8}) {
      for (double distance = 1.01 * margin_m_; distance < size_m_; distance *= 2.0) {
        for (const double side : {distance, -distance}) {
          any_position_ = beside.a + along * edge + side * normal;
          if (allows(any_position_)) return true;
        }
      }
    }
  }
  return false;
}

Vector2d WalkableArea::nearest_allowed(const Vector2d& position) const {
  if (!position.allFinite() || position.cwiseAbs().maxCoeff() > 100.0 * kMaxCoordinateM) return any_position_;
  if (allows(position)) return position;
  const Vector2d pushed = moved_inside(position);
  if (allows(pushed)) return pushed;
  Vector2d found = any_position_;
  return find_position_near(nearest_edge(position).point, &found) ? found : any_position_;
}

}  // namespace cyclorama::tour
