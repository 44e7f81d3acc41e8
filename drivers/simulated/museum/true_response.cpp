// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/museum/true_response.h"

#include <algorithm>
#include <cmath>

namespace cyclorama::simulated {

double TrueResponse::at(double x) const {
  if (!(x > 0.0)) return 0.0;
  const double y = std::min(x / clip, 1.0);
  const double from_dip = (x - 0.85) / 0.05;
  const double light =
      std::pow(y, gamma) + bend * y * (1.0 - y) * (1.0 - 2.0 * y) - dip * std::exp(-from_dip * from_dip);
  return std::clamp(light, 0.0, 1.0);
}

}  // namespace cyclorama::simulated
