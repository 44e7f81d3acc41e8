// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/museum/wall_deviation.h"

#include <cmath>

namespace cyclorama::simulated {

WallDeviation::Height WallDeviation::at(double s_m, double t_m) const {
  Height height;
  for (const Wave& wave : waves) {
    const double angle = wave.s_rad_per_m * s_m + wave.t_rad_per_m * t_m + wave.phase_rad;
    const double slope = wave.height_m * std::cos(angle);
    height.m += wave.height_m * std::sin(angle);
    height.by_s += slope * wave.s_rad_per_m;
    height.by_t += slope * wave.t_rad_per_m;
  }
  for (const Bump& bump : bumps) {
    const double ds = s_m - bump.s_m;
    const double dt = t_m - bump.t_m;
    const double narrow = 1.0 / (bump.sigma_m * bump.sigma_m);
    const double exponent = 0.5 * (ds * ds + dt * dt) * narrow;
    if (exponent > 50.0) continue;
    const double value = bump.height_m * std::exp(-exponent);
    height.m += value;
    height.by_s -= value * ds * narrow;
    height.by_t -= value * dt * narrow;
  }
  return height;
}

double WallDeviation::bound_m() const {
  double sum = 0.0;
  for (const Wave& wave : waves) sum += std::abs(wave.height_m);
  for (const Bump& bump : bumps) sum += std::abs(bump.height_m);
  return sum;
}

}  // namespace cyclorama::simulated
