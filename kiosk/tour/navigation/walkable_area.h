// SPDX-License-Identifier: Apache-2.0
/// Where a visitor may stand: a polygon on the ground of the scene, seen from above.
///
///        -z (ahead at heading 0)
///         ▲        A corner is (x, z), in metres of the Scene frame. The polygon closes by itself, may turn either way
///         │        round, and need not be convex.
///   ──────┼────► x
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/base/result.h"

namespace cyclorama {

/// A polygon that an eye never leaves. Immutable after make(); reentrant.
///
/// A place is *allowed* when it is inside and at least margin_m() from every edge: far more than rounding, so that
/// "inside" has one answer whichever way it is computed.
class WalkableArea {
 public:
  /// kInvalidArgument  fewer than three corners, more than kMostCorners, a corner that is not finite or beyond 10 000
  /// km,
  ///                   or a polygon in which there is no room to stand.
  static Result<WalkableArea> make(std::vector<Eigen::Vector2d> corners);
  static constexpr std::size_t kMostCorners = 1024;

  [[nodiscard]] bool allows(const Eigen::Vector2d& place) const;
  /// `place` itself when it is allowed, else an allowed place near the nearest edge. A NaN gives some allowed place.
  [[nodiscard]] Eigen::Vector2d nearest_allowed(const Eigen::Vector2d& place) const;
  /// Walks from `from` by `step`: an edge in the way turns the step along itself, also round a corner that juts in.
  /// The way from start to end crosses no edge. Precondition: allows(from). A step that is not finite is no step.
  [[nodiscard]] Eigen::Vector2d walk(const Eigen::Vector2d& from, const Eigen::Vector2d& step) const;
  /// True when the straight line between two allowed places crosses no edge.
  [[nodiscard]] bool sees(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const;

  [[nodiscard]] const std::vector<Eigen::Vector2d>& corners() const { return corners_; }
  /// How far the eye keeps from edges: 1 cm in a room of 20 m or more, 1/2000 of the size of smaller ones.
  [[nodiscard]] double margin_m() const { return margin_m_; }

 private:
  explicit WalkableArea(std::vector<Eigen::Vector2d> corners) : corners_(std::move(corners)) {}
  struct Contact {
    Eigen::Vector2d point;
    double distance = 0.0;
  };
  [[nodiscard]] bool contains(const Eigen::Vector2d& place) const;
  [[nodiscard]] Contact nearest_edge(const Eigen::Vector2d& place) const;
  /// Moves a place that is too near to edges, or outside, to the margin; it may still not be allowed (in a corner).
  [[nodiscard]] Eigen::Vector2d pushed_inside(Eigen::Vector2d place) const;
  [[nodiscard]] bool find_place_near(const Eigen::Vector2d& place, Eigen::Vector2d* ret_found) const;
  [[nodiscard]] bool find_some_place();

  std::vector<Eigen::Vector2d> corners_;
  double margin_m_ = 0.0;
  double size_m_ = 0.0;  ///< Diagonal of the box around it.
  Eigen::Vector2d some_place_ = Eigen::Vector2d::Zero();
};

}  // namespace cyclorama
