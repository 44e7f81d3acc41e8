// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/lights/light_list.h"

#include <cmath>

#include "common/base/check.h"

namespace cyclorama::render {

void LightList::add(const LightBounds& light) {
  CHECK(size_ < kMaxListedLights);
  if (size_ % 4 == 0) lanes_.emplace_back();
  lanes_.back().set(size_++ % 4, light);
}

void LightList::estimate(const Vec3& p, const Vec3& n, Estimates* ret_estimates) const {
  Eigen::Map<Eigen::Array<float, kMaxListedLights, 1>> out(ret_estimates->each.data());
  LightLanes::Four sum = LightLanes::Four::Zero();
  Eigen::Index first = 0;
  for (const LightLanes& lanes : lanes_) {
    const LightLanes::Four estimate = lanes.estimate(p, n);
    out.segment<4>(first) = estimate;
    first += 4;
    sum += estimate;
  }
  ret_estimates->sum = sum.sum();
}

int LightList::choose(const Estimates& estimates, const Choice& choice, float* ret_probability) const {
  if (!(estimates.sum > 0.0f) || !std::isfinite(estimates.sum)) return -1;
  double left = choice.number() * static_cast<double>(estimates.sum);
  int chosen = -1;
  for (std::size_t i = 0; i < size_; ++i) {
    const float e = estimates.each[i];
    if (!(e > 0.0f)) continue;
    // Rounding may leave a remainder after the last light, which is then chosen.
    chosen = static_cast<int>(i);
    left -= static_cast<double>(e);
    if (left < 0.0) break;
  }
  if (chosen >= 0) *ret_probability = estimates.each[static_cast<std::size_t>(chosen)] / estimates.sum;
  return chosen;
}

}  // namespace cyclorama::render
