// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light_baking/bake_settings.h"

#include <algorithm>
#include <bit>

namespace cyclorama::light_baking {

int BakeSettings::rays_of(int rays, std::uint64_t samples, int divisor) const {
  const std::uint64_t wanted = static_cast<std::uint64_t>(min_rays / divisor) / std::max<std::uint64_t>(samples, 1);
  const std::uint64_t most = std::min<std::uint64_t>(wanted, kMaxRaysOfSample);
  return std::max(rays, most > 0 ? static_cast<int>(std::bit_floor(most)) : 1);
}

}  // namespace cyclorama::light_baking
