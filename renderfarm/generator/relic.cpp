// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/generator/relic.h"

#include "renderfarm/generator/figures.h"

namespace cyclorama::generator {

Result<Grotto> plan_relic(std::uint64_t triangles, std::uint32_t seed) {
  TRY(check_triangles(triangles));
  Grotto relic;
  relic.kind = Kind::kRelic;
  relic.parts = {{"relic.ply", seated_buddha(standing_at({0.0f, 1.1f, 0.0f}, 0.0f, 1.0f), seed, 1.0f)}};
  relic.lamps = {{.name = "key",
                  .kind = "point",
                  .position = {2.0f, 3.0f, 2.5f},
                  .intensity_cd = {26.0f, 24.0f, 21.0f},
                  .radius_m = 0.2f},
                 {.name = "fill",
                  .kind = "point",
                  .position = {-2.5f, 1.5f, -2.0f},
                  .intensity_cd = {8.0f, 9.0f, 10.0f},
                  .radius_m = 0.3f}};
  TRY(share_triangles(relic.parts, triangles));
  return relic;
}

}  // namespace cyclorama::generator
