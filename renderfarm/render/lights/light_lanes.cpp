// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/lights/light_lanes.h"

namespace cyclorama::render {

LightLanes::LightLanes() {
  for (Four* const value :
       {&x_, &y_, &z_, &radius_, &axis_x_, &axis_y_, &axis_z_, &cos_edge_, &slope_, &power_, &inverse_range_}) {
    value->setZero();
  }
}

void LightLanes::set(std::size_t lane, const LightBounds& light) {
  const auto i = static_cast<Eigen::Index>(lane);
  const Vec3 centre = light.centre();
  const bool all_around = light.normals.cosine <= -1.0f;
  const Vec3 axis = all_around ? Vec3(Vec3::Zero()) : light.normals.axis;
  x_[i] = centre.x();
  y_[i] = centre.y();
  z_[i] = centre.z();
  radius_[i] = light.radius();
  axis_x_[i] = axis.x();
  axis_y_[i] = axis.y();
  axis_z_[i] = axis.z();
  cos_edge_[i] = all_around ? -1.0f : light.cos_emission;
  slope_[i] = all_around ? 1.0f : 1.0f / std::max(1e-4f, 1.0f - light.cos_emission);
  power_[i] = light.power;
  inverse_range_[i] = light.inverse_range;
}

}  // namespace cyclorama::render
