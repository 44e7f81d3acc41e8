// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace cyclorama::simulated {

/// Height of a wall above its ideal shape, towards the visitor: waves and bumps over the surface's coordinates (s to
/// the right, t upwards, metres from the centre). It must be gentle, since shadows that it would cast on itself are not
/// computed. A value; reentrant.
struct WallDeviation {
  struct Wave {
    double height_m = 0.0;
    double s_rad_per_m = 0.0;
    double t_rad_per_m = 0.0;
    double phase_rad = 0.0;
  };
  struct Bump {
    double height_m = 0.0;
    double s_m = 0.0;
    double t_m = 0.0;
    double sigma_m = 1.0;
  };
  std::vector<Wave> waves;
  std::vector<Bump> bumps;

  struct Height {
    double m = 0.0;
    double by_s = 0.0;
    double by_t = 0.0;
  };
  [[nodiscard]] Height at(double s_m, double t_m) const;
  [[nodiscard]] bool is_flat() const { return waves.empty() && bumps.empty(); }
  /// Upper bound of the deviation's magnitude.
  [[nodiscard]] double bound_m() const;
};

}  // namespace cyclorama::simulated
