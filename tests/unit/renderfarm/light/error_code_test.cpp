// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light/error_code.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "renderfarm/light/light_check.h"

namespace cyclorama::light {
namespace {

TEST(ErrorCode, is_never_below_the_error_and_at_most_a_step_above) {
  constexpr float kRatio = 1.37f;
  for (int i = 0; i < 86; ++i) {  // From 1e-7 to 6e4.
    const float error = 1e-7f * std::pow(kRatio, static_cast<float>(i));
    const float again = from_error_code(to_error_code(error));
    EXPECT_GE(again, error * 0.9999f);
    EXPECT_LE(again, error * 1.13f);
  }
}

TEST(ErrorCode, knows_none_and_takes_the_unknown_for_the_largest) {
  EXPECT_EQ(to_error_code(0.0f), 0);
  EXPECT_EQ(from_error_code(0), 0.0f);
  EXPECT_EQ(to_error_code(-1.0f), 0);
  EXPECT_EQ(to_error_code(1e-30f), 0);
  EXPECT_EQ(to_error_code(1e30f), 255);
  EXPECT_EQ(to_error_code(std::numeric_limits<float>::infinity()), 255);
  EXPECT_EQ(to_error_code(std::numeric_limits<float>::quiet_NaN()), 255);
}

TEST(Percentiles, are_those_of_the_nearest_rank) {
  EXPECT_EQ(percentiles_of({}), Percentiles{});
  EXPECT_EQ(percentiles_of({3.0f}), (Percentiles{3.0f, 3.0f, 3.0f}));
  std::vector<float> values;
  for (int i = 100; i >= 1; --i) values.push_back(static_cast<float>(i));
  EXPECT_EQ(percentiles_of(values), (Percentiles{50.0f, 95.0f, 99.0f}));
}

TEST(LightCheck, loses_to_paths_only_if_it_was_checked) {
  LightCheck check;
  check.relmse = {0.1f, 0.2f, 0.3f};
  check.relmse_of_paths = 0.05f;
  EXPECT_FALSE(check.loses_to_paths());
  check.eyes = 1;
  EXPECT_TRUE(check.loses_to_paths());
  check.relmse_of_paths = 0.2f;
  EXPECT_FALSE(check.loses_to_paths());
}

}  // namespace
}  // namespace cyclorama::light
