// SPDX-License-Identifier: Apache-2.0
// Stored light on surfaces that are not flat: at their vertices they hide parts of themselves.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "tests/unit/renderfarm/light_baking/light_cases.h"

namespace cyclorama::light_baking {
namespace {

Difference of_floor(scene::Scene scene) {
  const auto renderer = built(std::move(scene));
  baked(*renderer);
  // Downwards, where the floor is.
  return difference(*renderer, view_from({-0.4, 0.4, 0.7}, 128, 64, 0.1, -2.5), 128);
}

TEST(CurvedSurfaces, have_no_stripes_whether_whole_or_in_pieces) {
  for (const auto& [name, height] :
       {std::pair{"waves", &waves}, std::pair{"furrows", &furrows}, std::pair{"bowl", &bowl}}) {
    for (const int pieces : {1, 8}) {
      const Difference found = of_floor(lit_floor(pieces, 32 / pieces, height));
      EXPECT_LT(std::abs(found.relative_bias), 0.01) << name << " in " << pieces;
      EXPECT_LT(found.worst_codes, 4.0) << name << " in " << pieces;
    }
  }
}

}  // namespace
}  // namespace cyclorama::light_baking
