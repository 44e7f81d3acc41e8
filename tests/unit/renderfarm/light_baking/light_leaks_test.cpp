// SPDX-License-Identifier: Apache-2.0
// Small versions of the cases of ./bench.sh light-leaks.
#include <gtest/gtest.h>

#include "tests/data_sets/leak_cases.h"
#include "tests/unit/renderfarm/light_baking/light_cases.h"

namespace cyclorama::light_baking {
namespace {

TEST(LightLeaks, are_in_none_of_the_cases) {
  BakeSettings settings = quick();
  settings.pixels_per_degree = 4.0;
  settings.max_parts = 64;
  settings.min_bytes = std::uint64_t{1} << 18;
  for (LeakCase& leak : leak_cases(6)) {
    const auto renderer = built(std::move(leak.scene));
    baked(*renderer, settings);
    const Difference found = difference(*renderer, view_from(leak.eye, 64, 32, 1.5, -1.5), 128);
    EXPECT_LT(found.worst_codes, kMaxCodes) << leak.name;
  }
}

}  // namespace
}  // namespace cyclorama::light_baking
