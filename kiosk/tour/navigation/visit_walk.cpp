// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/navigation/visit_walk.h"

#include <cmath>
#include <utility>

namespace cyclorama::tour {
namespace {

/// Applies each event to the parts of the walk that it changes.
struct Apply {
  VisitWalk& walk;
  TimePoint at;
  const NavigationSettings& settings;

  void operator()(const SceneOpened& opened) const {
    const bool same = walk.open && walk.scene == opened.name;
    walk.scene = opened.name;
    walk.site = opened.site;
    if (!same) walk.navigation = started(walk.site);
    walk.open = true;
    // The same scene may have come back with another area.
    Walker& walker = walk.navigation.walker;
    walker.position_m =
        walk.site.area == nullptr ? walk.site.start.position_m : walk.site.area->nearest_allowed(walker.position_m);
    walk.navigation.guide = {};
    walk.navigation.stop.reset();  // The scene may have come back with other stops.
  }
  void operator()(const PoseSeen& seen) const {
    if (!walk.trackers[seen.tracker].is_news(seen.sequence, seen.shutter_ns, at)) return;
    const auto T_camera_tag = tag_pose_of(seen);
    if (!T_camera_tag || !walk.open || !walk.choice.sees_tag(seen.tracker, at, seen.body)) return;
    const auto with = seen.body ? with_body : with_tag;
    walk.navigation = with(std::move(walk.navigation), *T_camera_tag, at, settings);
  }
  void operator()(const TrackerLeft& left) const {
    walk.trackers.erase(left.tracker);
    walk.choice.leaves(left.tracker);
  }
  void operator()(const KeysPressed& keys) const {
    if (walk.open) walk.navigation = with_keys(std::move(walk.navigation), keys.command, at);
  }
  void operator()(const LedToStop& led_to) const {
    if (can_go_to(walk, led_to.stop)) walk.navigation = led(std::move(walk.navigation), walk.site, led_to.stop, at);
  }
  void operator()(const CutToStop& cut_to) const {
    if (can_go_to(walk, cut_to.stop)) walk.navigation = cut(std::move(walk.navigation), walk.site, cut_to.stop, at);
  }
  void operator()(const Held&) const {
    walk.site.is_held = true;
    walk.navigation.guide = {};
  }
  void operator()(const Tick&) const {
    if (walk.open) walk.navigation = advanced(std::move(walk.navigation), walk.site, settings, at);
  }
};

}  // namespace

bool can_go_to(const VisitWalk& walk, std::size_t stop) {
  return walk.open && walk.site.area != nullptr && stop < walk.site.stops.size();
}

WalkEvent way_to(const VisitWalk& walk, std::size_t stop) {
  if (needs_cut(walk.site, walk.navigation.walker, stop)) return CutToStop{stop};
  return LedToStop{stop};
}

std::optional<std::size_t> stop_after(const VisitWalk& walk, int step) {
  const auto count = static_cast<int>(walk.site.stops.size());
  if (count == 0) return std::nullopt;
  const std::optional<std::size_t> here =
      walk.navigation.stop ? walk.navigation.stop : stop_at(walk.site, walk.navigation.walker);
  if (!here) return nearest_stop(walk.site, walk.navigation.walker);
  const int next = (static_cast<int>(*here) + step % count + count) % count;
  return static_cast<std::size_t>(next);
}

VisitWalk after(VisitWalk walk, const WalkEvent& event, TimePoint at, const NavigationSettings& settings) {
  std::visit(Apply{walk, at, settings}, event);
  return walk;
}

std::optional<RigidTransform<frame::Camera, frame::Tag>> tag_pose_of(const PoseSeen& seen) {
  if (!seen.found) return std::nullopt;
  const Eigen::Vector3d position(seen.position_m[0], seen.position_m[1], seen.position_m[2]);
  const Eigen::Quaterniond rotation(seen.rotation[0], seen.rotation[1], seen.rotation[2], seen.rotation[3]);
  // Requires a unit quaternion up to rounding; anything else is a tracker's error.
  if (!position.allFinite() || !(std::abs(rotation.norm() - 1.0) < 1e-3)) return std::nullopt;
  return RigidTransform<frame::Camera, frame::Tag>(rotation, position);
}

}  // namespace cyclorama::tour
