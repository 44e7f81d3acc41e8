// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light/light_check.h"

#include <algorithm>
#include <cmath>

namespace cyclorama::light {

Percentiles percentiles_of(std::vector<float> values) {
  if (values.empty()) return {};
  std::ranges::sort(values);
  const auto at = [&](double share) {
    const double rank = std::ceil(share * static_cast<double>(values.size()));
    return values[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
  };
  return {at(0.5), at(0.95), at(0.99)};
}

}  // namespace cyclorama::light
