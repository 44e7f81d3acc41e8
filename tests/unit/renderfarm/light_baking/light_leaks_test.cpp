// SPDX-License-Identifier: Apache-2.0
// Small versions of the cases of ./bench.sh light-leaks.
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "tests/data_sets/leak_cases.h"
#include "tests/unit/renderfarm/light_baking/light_cases.h"

namespace cyclorama::light_baking {
namespace {

/// Upper bounds of the cases that leak; docs/design/stored-light.md lists them. All others hold kMaxCodes.
double bound_of(const std::string& name) {
  static const std::map<std::string, double> kBounds{{"a curtain", 13.0},
                                                     {"a corner to look around", 8.0},
                                                     {"a niche", 5.0},
                                                     {"a lamp in a bowl", 10.0},
                                                     {"a letter-box slit of sun", 11.0}};
  const auto known = kBounds.find(name);
  return known == kBounds.end() ? kMaxCodes : known->second;
}

TEST(LightLeaks, stay_within_the_bounds_of_the_cases) {
  BakeSettings settings = quick();
  settings.pixels_per_degree = 4.0;
  settings.max_parts = 64;
  settings.min_bytes = std::uint64_t{1} << 18;
  for (LeakCase& leak : leak_cases(6)) {
    const auto renderer = built(std::move(leak.scene));
    baked(*renderer, settings);
    const Difference found = difference(*renderer, view_from(leak.eye, 64, 32, 1.5, -1.5), 128);
    EXPECT_LT(found.worst_codes, bound_of(leak.name)) << leak.name;
  }
}

}  // namespace
}  // namespace cyclorama::light_baking
