// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/session/site.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "common/wire/convert.h"

namespace cyclorama {

Site site_of(const wire::SceneDescription& scene, std::string* ret_warning) {
  ret_warning->clear();
  Site site;
  site.start.place_m = {scene.start_eye_m().x(), scene.start_eye_m().z()};
  site.start.heading_rad = scene.start_heading_rad();
  site.walking_scale = scene.walking_scale();
  std::vector<Eigen::Vector2d> corners;
  for (const wire::GroundPoint& corner : scene.walkable()) corners.emplace_back(corner.x_m(), corner.z_m());
  auto area = WalkableArea::make(std::move(corners));
  if (!area) {
    *ret_warning =
        fmt::format("Nobody can walk here: {}. Correct 'walkable' in the scene's scene.toml.", area.error().message());
    return site;
  }
  site.area = std::make_shared<const WalkableArea>(*std::move(area));
  site.start.place_m = site.area->nearest_allowed(site.start.place_m);
  for (const wire::TourStop& stop : scene.stops()) {
    const Eigen::Vector2d place(stop.eye_m().x(), stop.eye_m().z());
    site.stops.push_back({stop.title(), site.area->nearest_allowed(place), stop.heading_rad()});
  }
  return site;
}

std::optional<RigidTransform<frame::Camera, frame::Tag>> tag_pose_of(const wire::TrackedPose& pose) {
  const Eigen::Quaterniond rotation(pose.rotation_w(), pose.rotation_x(), pose.rotation_y(), pose.rotation_z());
  const Eigen::Vector3d position = from_wire(pose.position_m());
  // The wire's quaternion is a unit one up to rounding; anything else is a tracker's fault and no pose.
  if (!position.allFinite() || !(std::abs(rotation.norm() - 1.0) < 1e-3)) return std::nullopt;
  return RigidTransform<frame::Camera, frame::Tag>(rotation, position);
}

}  // namespace cyclorama
