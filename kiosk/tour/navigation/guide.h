// SPDX-License-Identifier: Apache-2.0
/// The guide that leads from stop to stop while nobody steers, so that an empty room still invites. It only has wishes,
/// as a visitor has; the limits of walk.h make it, and taking over from it, smooth.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "kiosk/tour/navigation/walk.h"

namespace cyclorama {

struct GuideStop {
  std::string title;
  Eigen::Vector2d place_m = Eigen::Vector2d::Zero();  ///< (x, z) in the Scene frame.
  double heading_rad = 0.0;
};

/// Of a scene, what a walk in it needs. A value.
struct Site {
  std::shared_ptr<const WalkableArea> area;  ///< Null: the visitor stands and turns.
  Walker start;
  double walking_scale = 1.0;
  std::vector<GuideStop> stops;  ///< Their places are allowed.
};

/// Where the guide is on its round. A value; a new one starts with the way to the nearest stop.
struct GuideState {
  bool started = false;
  std::size_t stop = 0;
  std::vector<Eigen::Vector2d> way;  ///< Places still to pass; the last one is the stop.
  bool dwelling = false;
  TimePoint since{};       ///< When it came to the stop, or set out for it.
  TimePoint nearer_at{};   ///< When it last came nearer to the next place.
  double nearest_m = 0.0;  ///< How near it came.
};

/// The guide's wish now. It looks where it walks and then where the stop looks, stays there for some seconds with a
/// slow glance around, and goes on. A stop that it cannot reach is passed over. Without stops it slowly looks around.
[[nodiscard]] SteeringWish guide_wish(GuideState* state, const Walker& walker, const Site& site,
                                      const WalkLimits& limits, TimePoint now);

/// The shortest way from one allowed place to another, round the corners that jut in; ends with `to`. In an area of
/// very many corners, or when there is no way, just `to`.
[[nodiscard]] std::vector<Eigen::Vector2d> shortest_way(const WalkableArea& area, const Eigen::Vector2d& from,
                                                        const Eigen::Vector2d& to);

}  // namespace cyclorama
