// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/session/site.h"

#include <fmt/format.h>

#include <utility>
#include <vector>

namespace cyclorama::tour {

Site site_of(const wire::SceneDescription& scene, std::string* ret_warning) {
  ret_warning->clear();
  Site site;
  site.start.position_m = {scene.start_eye_m().x(), scene.start_eye_m().z()};
  site.start.heading_rad = scene.start_heading_rad();
  site.walking_scale = scene.walking_scale();
  std::vector<Eigen::Vector2d> corners;
  for (const wire::GroundPoint& corner : scene.walkable()) corners.emplace_back(corner.x_m(), corner.z_m());
  std::vector<std::vector<Eigen::Vector2d>> holes;
  for (const wire::GroundPolygon& polygon : scene.walkable_holes()) {
    std::vector<Eigen::Vector2d>& hole = holes.emplace_back();
    for (const wire::GroundPoint& corner : polygon.corners()) hole.emplace_back(corner.x_m(), corner.z_m());
  }
  auto area = WalkableArea::make(std::move(corners), holes);
  if (!area) {
    *ret_warning =
        fmt::format("Nobody can walk here: {}. Correct 'walkable' in the scene's scene.toml.", area.error().message());
    return site;
  }
  site.area = std::make_shared<const WalkableArea>(*std::move(area));
  site.start.position_m = site.area->nearest_allowed(site.start.position_m);
  for (const wire::TourStop& stop : scene.stops()) {
    const Eigen::Vector2d position(stop.eye_m().x(), stop.eye_m().z());
    site.stops.push_back({stop.title(), site.area->nearest_allowed(position), stop.heading_rad(),
                          fmt::format("stop-{}", site.stops.size() + 1)});
  }
  return site;
}

PoseSeen pose_seen(std::uint64_t tracker, const wire::TrackedPose& pose) {
  PoseSeen seen;
  seen.tracker = tracker;
  seen.sequence = pose.sequence();
  seen.shutter_ns = pose.shutter_ns();
  seen.found = pose.found();
  seen.body = pose.body();
  seen.position_m = {pose.position_m().x(), pose.position_m().y(), pose.position_m().z()};
  seen.rotation = {pose.rotation_w(), pose.rotation_x(), pose.rotation_y(), pose.rotation_z()};
  return seen;
}

}  // namespace cyclorama::tour
