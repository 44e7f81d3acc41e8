// SPDX-License-Identifier: Apache-2.0
/// The walkable area: a polygon on the ground of the scene, seen from above.
///
///        -z (ahead at heading 0)
///         ▲        A corner is (x, z), in metres of the Scene frame. The polygon is closed implicitly, may have either
///         │        orientation, and need not be convex.
///   ──────┼────► x    Holes, such as pillars, are polygons of the same kind inside it.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "common/base/result.h"

namespace cyclorama::tour {

/// A polygon, perhaps with holes, that an eye never leaves. Immutable after make(); reentrant.
///
/// A position is *allowed* when it is inside and at least margin_m() from every edge. The margin is far above rounding
/// errors, so that every way to compute "inside" gives the same answer.
class WalkableArea {
 public:
  /// Errors: kInvalidArgument for a polygon of fewer than three corners, more than kMaxCorners in all, a corner that
  /// is not finite or beyond 10 000 km, or no room to stand.
  static Result<WalkableArea> make(std::vector<Eigen::Vector2d> corners,
                                   const std::vector<std::vector<Eigen::Vector2d>>& holes = {});
  static constexpr std::size_t kMaxCorners = 1024;

  [[nodiscard]] bool allows(const Eigen::Vector2d& position) const;
  /// Returns `position` itself if it is allowed, otherwise an allowed position near the nearest edge; for NaN, any
  /// allowed position.
  [[nodiscard]] Eigen::Vector2d nearest_allowed(const Eigen::Vector2d& position) const;
  /// Returns the end of a walk from `from` by `step`. The step slides along an edge in its way, also around a corner
  /// that projects into the area; the path crosses no edge. A step that is not finite counts as zero. Precondition:
  /// allows(from).
  [[nodiscard]] Eigen::Vector2d walk(const Eigen::Vector2d& from, const Eigen::Vector2d& step) const;
  /// Returns true when the straight line between two allowed positions crosses no edge.
  [[nodiscard]] bool sees(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const;

  /// Calls `use(point, distance)` for each edge nearer than `within_m`, with the edge's point nearest to `position`.
  /// Skips an edge that `position` lies ON: there is no direction to it, and such a position is never allowed.
  template <typename Use>
  void for_edges_within(const Eigen::Vector2d& position, double within_m, const Use& use) const {
    for (const Edge& edge : edges_) {
      const Eigen::Vector2d point = edge.nearest_to(position);
      const double distance = (position - point).norm();
      if (distance < within_m && distance > 0.0) use(point, distance);
    }
  }

  /// Corners of the outline, then of the holes.
  [[nodiscard]] const std::vector<Eigen::Vector2d>& corners() const { return corners_; }
  /// The outline, then the holes.
  [[nodiscard]] std::vector<std::vector<Eigen::Vector2d>> polygons() const;
  /// Distance of the eye from the edges: 1 cm in a room of 20 m or more, 1/2000 of the size of a smaller room.
  [[nodiscard]] double margin_m() const { return margin_m_; }
  /// Diagonal of the bounding box of all corners.
  [[nodiscard]] double size_m() const { return size_m_; }

 private:
  struct Edge {
    Eigen::Vector2d a;
    Eigen::Vector2d b;
    [[nodiscard]] Eigen::Vector2d nearest_to(const Eigen::Vector2d& position) const;
  };
  WalkableArea() = default;
  void add(const std::vector<Eigen::Vector2d>& polygon);
  [[nodiscard]] bool is_within(const Eigen::Vector2d& position, std::size_t first_edge, std::size_t end_edge) const;
  struct Contact {
    Eigen::Vector2d point;
    double distance = 0.0;
  };
  [[nodiscard]] bool contains(const Eigen::Vector2d& position) const;
  [[nodiscard]] Contact nearest_edge(const Eigen::Vector2d& position) const;
  /// Moves a position that is outside or too near to edges to the margin; in a corner it may still not be allowed.
  [[nodiscard]] Eigen::Vector2d moved_inside(Eigen::Vector2d position) const;
  [[nodiscard]] bool find_position_near(const Eigen::Vector2d& position, Eigen::Vector2d* ret_found) const;
  [[nodiscard]] bool find_any_position();

  std::vector<Eigen::Vector2d> corners_;
  std::vector<Edge> edges_;
  /// End of each polygon in edges_: first the outline, then the holes.
  std::vector<std::size_t> polygon_ends_;
  double margin_m_ = 0.0;
  double size_m_ = 0.0;
  Eigen::Vector2d any_position_ = Eigen::Vector2d::Zero();
};

}  // namespace cyclorama::tour
