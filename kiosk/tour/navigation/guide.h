// SPDX-License-Identifier: Apache-2.0
/// The guide leads from stop to stop while nobody steers, so that an empty room still attracts visitors. It only issues
/// steering commands, as a visitor does; the limits of walk.h keep its motion smooth, also when a visitor takes over.
/// On request it leads to one stop in the same way. It never cuts by itself: guide_cut() returns when one is due.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kiosk/tour/navigation/walk.h"

namespace cyclorama::tour {

struct GuideStop {
  std::string title;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< (x, z) in the Scene frame.
  double heading_rad = 0.0;
  std::string name{};                       ///< Unique in its tour.
  Duration stay = std::chrono::seconds(8);  ///< Time for which the guide stays there.
};

/// A way from one stop to another, in either direction, where it is not the shortest one on foot.
struct GuideWay {
  std::size_t from = 0;
  std::size_t to = 0;
  std::vector<Eigen::Vector2d> through{};  ///< Positions in the walkable area that the walk passes, in order.
  bool is_cut = false;                     ///< The picture fades from one stop to the other; nobody walks.
};

/// Properties of a scene, and of a tour through it, that a walk needs. A value.
struct Site {
  std::shared_ptr<const WalkableArea> area;  ///< Null: the visitor cannot walk, only turn.
  Walker start;
  double walking_scale = 1.0;
  std::vector<GuideStop> stops;  ///< Their positions lie in the walkable area.
  std::vector<GuideWay> ways{};
  /// Shares of the museum's speed limits, in [0, 1], that the tour allows for walking and for turning.
  double pace = 1.0;
  double turn_pace = 1.0;
  bool reduced_motion = false;  ///< The guide cuts from stop to stop instead of walking.
  bool is_held = false;         ///< Only kept pictures of stops can be shown: nobody walks, and the guide cuts.
};

/// Progress of the guide's round. A value; a new state starts with the path to the nearest stop.
struct GuideState {
  bool started = false;
  std::size_t stop = 0;
  std::vector<Eigen::Vector2d> path;  ///< Positions still to be passed; the last one is the stop.
  bool dwelling = false;
  bool is_led = false;     ///< Leads to `stop` on request, and then ends.
  TimePoint since{};       ///< Time of arrival at the stop, or of departure for it.
  TimePoint nearer_at{};   ///< Last time at which the distance to the next position fell.
  double nearest_m = 0.0;  ///< Minimum distance to the next position so far, in metres.
};

/// Returns the guide's steering command at `now`. The guide faces where it walks and then the stop's heading, stays
/// there for some seconds with a slow glance around, and goes on. It skips a stop that it cannot reach. Without stops
/// it slowly looks around. Where guide_cut() returns a stop, it rests.
[[nodiscard]] SteeringCommand guide_command(GuideState* state, const Walker& walker, const Site& site,
                                            const WalkLimits& limits, TimePoint now);

/// Returns the stop that the guide's round has to continue at with a cut; nothing while it walks or stays.
[[nodiscard]] std::optional<std::size_t> guide_cut(const GuideState& state, const Walker& walker, const Site& site,
                                                   TimePoint now);

/// Returns true if a visitor at this position gets to the stop only by a cut. Precondition: stop < site.stops.size().
[[nodiscard]] bool needs_cut(const Site& site, const Walker& walker, std::size_t stop);

/// Returns the state in which the guide leads to the stop. Preconditions: site.area is set, !needs_cut().
[[nodiscard]] GuideState led_to(const Site& site, const Walker& walker, std::size_t stop, TimePoint now);

/// Returns the stop whose position is within arm's length of the visitor; nothing if there is none.
[[nodiscard]] std::optional<std::size_t> stop_at(const Site& site, const Walker& walker);

/// Returns the stop nearest to the visitor. Precondition: there are stops.
[[nodiscard]] std::size_t nearest_stop(const Site& site, const Walker& walker);

/// Returns the shortest path between two allowed positions, around the corners that project into the area; it ends with
/// `to`. In an area with very many corners, or without a path, it is just `to`.
[[nodiscard]] std::vector<Eigen::Vector2d> shortest_path(const WalkableArea& area, const Eigen::Vector2d& from,
                                                         const Eigen::Vector2d& to);

}  // namespace cyclorama::tour
