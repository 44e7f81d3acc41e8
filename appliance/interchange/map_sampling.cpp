// SPDX-License-Identifier: Apache-2.0
#include "appliance/interchange/map_sampling.h"

#include <algorithm>
#include <cmath>

namespace cyclorama::interchange {
namespace {

/// The two neighbours of a position along one side, and the share of the second in an interpolation.
struct Between {
  int first = 0;
  int second = 0;
  double share = 0.0;

  Between(double at, int count) {
    if (count < 2) return;
    const double location = at * count - 0.5;
    first = static_cast<int>(std::clamp(std::floor(location), 0.0, count - 2.0));
    second = first + 1;
    share = location - first;
  }
  [[nodiscard]] int nearest() const { return share < 0.5 ? first : second; }
};

Eigen::Vector3d vector_of(const float* sample) {
  return Eigen::Vector3f(sample[0], sample[1], sample[2]).cast<double>();
}

}  // namespace

bool is_mapped(const float* sample) { return std::isfinite(sample[0]) && std::isfinite(sample[1]); }

std::optional<Eigen::Vector3d> sample_map(const WarpMap& map, double x, double y) {
  const Between across(x, map.width());
  const Between down(y, map.height());
  const float* const a = map.at(across.first, down.first);
  const float* const b = map.at(across.second, down.first);
  const float* const c = map.at(across.first, down.second);
  const float* const d = map.at(across.second, down.second);
  if (is_mapped(a) && is_mapped(b) && is_mapped(c) && is_mapped(d)) {
    const Eigen::Vector3d upper = (1.0 - across.share) * vector_of(a) + across.share * vector_of(b);
    const Eigen::Vector3d lower = (1.0 - across.share) * vector_of(c) + across.share * vector_of(d);
    return (1.0 - down.share) * upper + down.share * lower;
  }
  const float* const nearest = map.at(across.nearest(), down.nearest());
  if (!is_mapped(nearest)) return std::nullopt;
  return vector_of(nearest);
}

double sample_light(const MaskMap& mask, double x, double y) {
  Between across(x, mask.width_px);
  Between down(y, mask.height_px);
  across.share = std::clamp(across.share, 0.0, 1.0);
  down.share = std::clamp(down.share, 0.0, 1.0);
  const auto row = [&](int line) {
    return (1.0 - across.share) * mask.light_at(across.first, line) + across.share * mask.light_at(across.second, line);
  };
  return (1.0 - down.share) * row(down.first) + down.share * row(down.second);
}

}  // namespace cyclorama::interchange
