// SPDX-License-Identifier: Apache-2.0
// Small versions of the cases of ./bench.sh light-leaks.
#include <gtest/gtest.h>

#include "tests/data_sets/leak_cases.h"
#include "tests/unit/renderfarm/light_baking/light_cases.h"

namespace cyclorama::light_baking {
namespace {

TEST(LightLeaks, stay_below_what_a_visitor_might_notice) {
  BakeSettings settings = quick();
  settings.pixels_per_degree = 4.0;
  settings.max_parts = 64;
  settings.min_bytes = std::uint64_t{1} << 18;
  for (LeakCase& leak : leak_cases(6)) {
    const auto renderer = built(std::move(leak.scene));
    baked(*renderer, settings);
    const Difference found = difference(*renderer, view_from(leak.eye, 64, 32, 1.5, -1.5), 128);
    // Few rays of a bounce find the bright inside of the bowl, so its light is noisy. That is no leak.
    EXPECT_LT(found.worst_codes, leak.name == "a lamp in a bowl" ? 8.0 : kMaxCodes) << leak.name;
  }
}

}  // namespace
}  // namespace cyclorama::light_baking
