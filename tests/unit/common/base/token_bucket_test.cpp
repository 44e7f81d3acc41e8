// SPDX-License-Identifier: Apache-2.0
#include "common/base/token_bucket.h"

#include <gtest/gtest.h>

namespace cyclorama {
namespace {

TEST(TokenBucket, permits_a_burst_and_then_the_rate) {
  TokenBucket bucket(10.0, 5.0);
  const TimePoint start = TimePoint{} + std::chrono::hours(1);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(bucket.take(1.0, start), start);
  EXPECT_NEAR(to_seconds(bucket.take(1.0, start) - start), 0.1, 1e-6);
  EXPECT_NEAR(to_seconds(bucket.take(2.0, start) - start), 0.3, 1e-6);
  const TimePoint later = start + std::chrono::seconds(10);
  EXPECT_EQ(bucket.take(5.0, later), later);
}

TEST(TokenBucket, keeps_the_mean_rate_and_saves_nothing_without_a_burst) {
  TokenBucket bucket(1000.0, 0.0);
  const TimePoint start(std::chrono::seconds(100));
  EXPECT_LE(bucket.paid_at(), start);
  EXPECT_EQ(bucket.take(500.0, start), start + std::chrono::milliseconds(500));
  EXPECT_EQ(bucket.take(500.0, bucket.paid_at()), start + std::chrono::seconds(1));
  EXPECT_EQ(bucket.take(100.0, start + std::chrono::seconds(50)), start + std::chrono::milliseconds(50'100));
  EXPECT_EQ(bucket.paid_at(), start + std::chrono::milliseconds(50'100));
}

TEST(TokenBucket, permits_the_burst_just_after_the_clock_began) {
  TokenBucket bucket(1.0 / 3600.0, 3.0);
  const TimePoint start(std::chrono::seconds(1));
  for (int i = 0; i < 3; ++i) EXPECT_EQ(bucket.take(1.0, start), start);
  EXPECT_NEAR(to_seconds(bucket.take(1.0, start) - start), 3600.0, 1e-6);
}

TEST(TokenBucket, never_waits_without_a_rate) {
  TokenBucket bucket(0.0, 0.0);
  const TimePoint start(std::chrono::seconds(100));
  EXPECT_EQ(bucket.take(1e12, start), start);
  EXPECT_LE(bucket.paid_at(), start);
}

}  // namespace
}  // namespace cyclorama
