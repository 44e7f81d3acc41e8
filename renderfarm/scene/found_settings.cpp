// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/found_settings.h"

#include <algorithm>
#include <numbers>

namespace cyclorama {
namespace {

constexpr double kEyeHeightM = 1.6;
constexpr double kLeastRoomM = 2.2;  ///< A visitor fits into a room of this height.

bool is_room(const Eigen::AlignedBox3d& bounds) {
  const Eigen::Vector3d size = bounds.sizes();
  return size.y() > kLeastRoomM && std::min(size.x(), size.z()) > kLeastRoomM;
}

std::vector<Eigen::Vector2d> rectangle(double x0, double z0, double x1, double z1) {
  return {{x0, z0}, {x1, z0}, {x1, z1}, {x0, z1}};
}

}  // namespace

FoundSettings find_settings(const Model&, const Eigen::AlignedBox3d& bounds) {
  const Eigen::Vector3d middle = bounds.center();
  const Eigen::Vector3d size = bounds.sizes();
  FoundSettings found;
  if (is_room(bounds)) {
    found.eye = {middle.x(), bounds.min().y() + kEyeHeightM, middle.z()};
    found.heading_rad = size.x() > size.z() ? 0.5 * std::numbers::pi : 0.0;
    found.walkable = rectangle(middle.x() - 0.3 * size.x(), middle.z() - 0.3 * size.z(), middle.x() + 0.3 * size.x(),
                               middle.z() + 0.3 * size.z());
    return found;
  }
  const double distance = std::max(1.6 * std::max(size.y(), 0.7 * size.x()), 1e-3);
  found.eye = {middle.x(), middle.y(), bounds.max().z() + distance};
  found.eye_height_m = std::max(found.eye.y() - bounds.min().y(), 1e-3);
  found.walking_scale = distance / 2.0;
  found.walkable = rectangle(middle.x() - distance, bounds.max().z() + 0.5 * distance, middle.x() + distance,
                             bounds.max().z() + 2.0 * distance);
  return found;
}

void add_light(const FoundSettings& found, Scene* scene) {
  if (is_room(scene->bounds)) {
    const double reach = 0.25 * std::min(scene->bounds.sizes().x(), scene->bounds.sizes().z());
    scene->eye_lamp.setConstant(static_cast<float>(3.0 * reach * reach));
    scene->ambient.setConstant(0.08f);
    return;
  }
  scene->sky = {Eigen::Vector3f::Constant(0.6f), Eigen::Vector3f::Constant(0.4f), Eigen::Vector3f::Constant(0.2f)};
  Light key;
  key.name = "key";
  key.kind = LightKind::kDirectional;
  key.direction = Eigen::Vector3d(0.5, -0.7, scene->bounds.center().z() < found.eye.z() ? -0.6 : 0.6).normalized();
  key.intensity.setConstant(1.5f);
  key.radius_m = 0.05;
  scene->model.lights.push_back(std::move(key));
}

}  // namespace cyclorama
