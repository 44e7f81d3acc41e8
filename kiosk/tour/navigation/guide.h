// SPDX-License-Identifier: Apache-2.0
/// The guide leads from stop to stop while nobody steers, so that an empty room still attracts visitors. It only issues
/// steering commands, as a visitor does; the limits of walk.h keep its motion smooth, also when a visitor takes over.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "kiosk/tour/navigation/walk.h"

namespace cyclorama::tour {

struct GuideStop {
  std::string title;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< (x, z) in the Scene frame.
  double heading_rad = 0.0;
};

/// Properties of a scene that a walk in it needs. A value.
struct Site {
  std::shared_ptr<const WalkableArea> area;  ///< Null: the visitor cannot walk, only turn.
  Walker start;
  double walking_scale = 1.0;
  std::vector<GuideStop> stops;  ///< Their positions lie in the walkable area.
};

/// Progress of the guide's round. A value; a new state starts with the path to the nearest stop.
struct GuideState {
  bool started = false;
  std::size_t stop = 0;
  std::vector<Eigen::Vector2d> path;  ///< Positions still to be passed; the last one is the stop.
  bool dwelling = false;
  TimePoint since{};       ///< Time of arrival at the stop, or of departure for it.
  TimePoint nearer_at{};   ///< Last time at which the distance to the next position fell.
  double nearest_m = 0.0;  ///< Minimum distance to the next position so far, in metres.
};

/// Returns the guide's steering command at `now`. The guide faces where it walks and then the stop's heading, stays
/// there for some seconds with a slow glance around, and goes on. It skips a stop that it cannot reach. Without stops
/// it slowly looks around.
[[nodiscard]] SteeringCommand guide_command(GuideState* state, const Walker& walker, const Site& site,
                                            const WalkLimits& limits, TimePoint now);

/// Returns the shortest path between two allowed positions, around the corners that project into the area; it ends with
/// `to`. In an area with very many corners, or without a path, it is just `to`.
[[nodiscard]] std::vector<Eigen::Vector2d> shortest_path(const WalkableArea& area, const Eigen::Vector2d& from,
                                                         const Eigen::Vector2d& to);

}  // namespace cyclorama::tour
