// SPDX-License-Identifier: Apache-2.0
#include "common/base/percentiles.h"

#include <gtest/gtest.h>

#include <limits>

namespace cyclorama {
namespace {

TEST(Percentiles, are_zero_without_samples) {
  const Percentiles none;
  EXPECT_EQ(none.count(), 0u);
  EXPECT_EQ(none.at(0.5), 0.0);
  EXPECT_EQ(none.mean(), 0.0);
}

TEST(Percentiles, are_samples_by_nearest_rank) {
  Percentiles hundred;
  for (int i = 100; i >= 1; --i) hundred.add(i);
  EXPECT_EQ(hundred.at(0.50), 50.0);
  EXPECT_EQ(hundred.at(0.95), 95.0);
  EXPECT_EQ(hundred.at(0.99), 99.0);
  EXPECT_EQ(hundred.at(1.0), 100.0);
  EXPECT_EQ(hundred.at(0.0), 1.0);
  EXPECT_EQ(hundred.mean(), 50.5);
}

TEST(Percentiles, forget_samples_that_left_the_window_but_count_them) {
  Percentiles few(3);
  for (const double sample : {100.0, 1.0, 2.0, 3.0}) few.add(sample);
  EXPECT_EQ(few.count(), 4u);
  EXPECT_EQ(few.at(1.0), 3.0);
}

TEST(Percentiles, ignore_nan_and_sort_infinity) {
  Percentiles odd;
  odd.add(std::numeric_limits<double>::quiet_NaN());
  odd.add(1.0);
  odd.add(std::numeric_limits<double>::infinity());
  EXPECT_EQ(odd.count(), 2u);
  EXPECT_EQ(odd.at(0.5), 1.0);
}

}  // namespace
}  // namespace cyclorama
