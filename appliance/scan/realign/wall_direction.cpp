// SPDX-License-Identifier: Apache-2.0
#include "appliance/scan/realign/wall_direction.h"

#include <cmath>

namespace cyclorama::scan {
namespace {
constexpr double kMaxDistanceM = 1e4;
constexpr double kFirst_m = 0.25;
constexpr int kMaxSteps = 80;
constexpr double kOnTheWall = 1e-12;  // Relative to the distance from the sweet spot.
}  // namespace

std::optional<Eigen::Vector3d> wall_direction_from(const Eigen::Vector3d& centre_m, const Eigen::Vector3d& along,
                                                   const InverseDepthAt& inverse_depth) {
  const double length = along.norm();
  if (!(length > 0.0) || !centre_m.allFinite() || !std::isfinite(length)) return std::nullopt;
  const Eigen::Vector3d step = along / length;
  // Returns a value that is negative in front of the wall and positive behind it.
  const auto beyond = [&](double s) {
    const Eigen::Vector3d position = centre_m + s * step;
    const double distance = position.norm();
    if (!(distance > 1e-9)) return -1.0;
    const double near = inverse_depth(position / distance);
    return near > 0.0 ? distance * near - 1.0 : -1.0;
  };
  double low = 0.0;
  double at_low = beyond(low);
  if (at_low > 0.0) return std::nullopt;
  double high = kFirst_m;
  double at_high = beyond(high);
  while (at_high <= 0.0) {
    low = high;
    at_low = at_high;
    high *= 1.5;
    if (high > kMaxDistanceM) return std::nullopt;
    at_high = beyond(high);
  }
  // Regula falsi in the Illinois variant, which halves the value at an end that does not move: as safe as bisection,
  // and faster.
  int stays = 0;
  double s = high;
  for (int round = 0; round < kMaxSteps && high - low > kOnTheWall * high; ++round) {
    s = (low * at_high - high * at_low) / (at_high - at_low);
    if (!(s > low && s < high)) s = 0.5 * (low + high);
    const double at = beyond(s);
    if (std::abs(at) < kOnTheWall) break;
    if (at > 0.0) {
      high = s;
      at_high = at;
      if (stays > 0) at_low *= 0.5;
      stays = 1;
    } else {
      low = s;
      at_low = at;
      if (stays < 0) at_high *= 0.5;
      stays = -1;
    }
  }
  const Eigen::Vector3d position = centre_m + s * step;
  if (!(position.norm() > 1e-9)) return std::nullopt;
  return position.normalized();
}

}  // namespace cyclorama::scan
