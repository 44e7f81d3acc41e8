// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/one_euro.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <random>

namespace cyclorama::tracker {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using std::chrono::milliseconds;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
const TimePoint kStart(std::chrono::seconds(1000));
constexpr OneEuroSettings kCalm{1.0, 0.0, 1.0};

Quaterniond yaw(double rad) { return Quaterniond(Eigen::AngleAxisd(rad, Vector3d::UnitY())); }

TEST(OneEuro, starts_at_the_first_measurement) {
  const auto first = filter(kCalm, std::optional<FilteredPosition>(), Vector3d(1, 2, 3), kStart);
  ASSERT_TRUE(first.has_value());
  EXPECT_EQ(first->value, Vector3d(1, 2, 3));
}

TEST(OneEuro, has_the_step_response_of_a_low_pass) {
  // After one time constant, 1 / (2 pi f), a first-order low-pass has gone 63 % of the way.
  std::optional<FilteredPosition> state;
  for (int ms = 0; ms <= 159; ++ms) {
    state = filter(kCalm, state, ms == 0 ? Vector3d::Zero() : Vector3d(1, 0, 0), kStart + milliseconds(ms));
  }
  EXPECT_NEAR(state->value.x(), 0.632, 0.01);
}

TEST(OneEuro, takes_the_speed_from_the_last_result) {
  // Algorithm 1 by hand: with a cut-off of 1 / (2 pi) Hz and steps of a second, the share of a new value is one half.
  constexpr double kHalf = 0.5 / std::numbers::pi;
  const OneEuroSettings settings{kHalf, kHalf, kHalf};
  auto state = filter(settings, std::optional<FilteredPosition>(), Vector3d::Zero(), kStart);
  state = filter(settings, state, Vector3d(4, 0, 0), kStart + std::chrono::milliseconds(400));
  // Step of 0.4 s: the speed is 10, of which 2/7 remain; the cut-off is 1 + 20/7 times that at rest.
  const double first_speed = 10.0 * 2.0 / 7.0;
  const double first = 4.0 * 0.4 * (1.0 + first_speed) / (1.0 + 0.4 * (1.0 + first_speed));
  EXPECT_NEAR(state->value.x(), first, 1e-9);
  state = filter(settings, state, Vector3d(4, 0, 0), kStart + std::chrono::milliseconds(800));
  // The measurement rests, and yet the result still has a way to go: that is the speed.
  const double second_speed = first_speed + ((4.0 - first) / 0.4 - first_speed) * 2.0 / 7.0;
  const double share = 0.4 * (1.0 + second_speed) / (1.0 + 0.4 * (1.0 + second_speed));
  EXPECT_NEAR(state->value.x(), first + share * (4.0 - first), 1e-9);
}

TEST(OneEuro, smooths_a_hand_at_rest_and_follows_one_in_motion) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, 0.001);
  const OneEuroSettings settings{1.0, 10.0, 1.0};
  std::optional<FilteredPosition> state;
  double rest = 0.0;
  double late = 0.0;
  for (int i = 0; i < 300; ++i) {
    const double truth = i < 150 ? 0.0 : 0.5 * (i - 150) / 30.0;
    state = filter(settings, state, Vector3d(truth + noise(random), 0, 0), kStart + milliseconds(33) * i);
    if (i > 50 && i < 150) rest = std::max(rest, std::abs(state->value.x()));
    if (i > 250) late = std::max(late, std::abs(state->value.x() - truth));
  }
  EXPECT_LT(rest, 0.0016);
  EXPECT_LT(late, 0.03);  // 1 Hz alone would lag by 0.08 m.
}

TEST(OneEuro, ignores_time_stamps_that_repeat_or_go_back_a_little) {
  auto state = filter(kCalm, std::optional<FilteredPosition>(), Vector3d(0, 0, 0), kStart);
  for (const auto shift : {milliseconds(0), milliseconds(-1), milliseconds(-499)}) {
    const auto next = filter(kCalm, state, Vector3d(9, 9, 9), kStart + shift);
    ASSERT_TRUE(next.has_value());
    EXPECT_EQ(next->value, state->value);
    EXPECT_EQ(next->at, kStart);
  }
}

TEST(OneEuro, restarts_after_a_gap_in_either_direction) {
  const auto state = filter(kCalm, std::optional<FilteredPosition>(), Vector3d(0, 0, 0), kStart);
  for (const TimePoint at : {kStart + milliseconds(500), kStart - milliseconds(500), TimePoint::max(), TimePoint()}) {
    const auto next = filter(kCalm, state, Vector3d(9, 9, 9), at);
    ASSERT_TRUE(next.has_value());
    EXPECT_EQ(next->value, Vector3d(9, 9, 9));
  }
}

TEST(OneEuro, ignores_measurements_that_are_not_finite) {
  EXPECT_FALSE(filter(kCalm, std::optional<FilteredPosition>(), Vector3d(kNan, 0, 0), kStart).has_value());
  const auto state = filter(kCalm, std::optional<FilteredPosition>(), Vector3d(1, 1, 1), kStart);
  EXPECT_EQ(filter(kCalm, state, Vector3d(0, kNan, 0), kStart + milliseconds(30))->value, state->value);
  const auto turned = filter(kCalm, std::optional<FilteredRotation>(), yaw(0.1), kStart);
  for (const Quaterniond& bad : {Quaterniond(kNan, 0, 0, 0), Quaterniond(0, 0, 0, 0)}) {
    EXPECT_EQ(filter(kCalm, turned, bad, kStart + milliseconds(30))->value.coeffs(), turned->value.coeffs());
    EXPECT_FALSE(filter(kCalm, std::optional<FilteredRotation>(), bad, kStart).has_value());
  }
}

TEST(OneEuro, turns_the_short_way_for_either_sign_of_the_quaternion) {
  std::optional<FilteredRotation> state = filter(kCalm, std::optional<FilteredRotation>(), yaw(0.0), kStart);
  const Quaterniond target = yaw(0.2);
  const Quaterniond negated(-target.w(), -target.x(), -target.y(), -target.z());
  const auto one = filter(kCalm, state, target, kStart + milliseconds(33));
  const auto two = filter(kCalm, state, negated, kStart + milliseconds(33));
  EXPECT_NEAR(one->value.angularDistance(two->value), 0.0, 1e-7);
  const double turned = one->value.angularDistance(yaw(0.0));
  EXPECT_GT(turned, 0.01);
  EXPECT_LT(turned, 0.1);
}

TEST(OneEuro, follows_a_constant_turn_with_a_constant_delay) {
  const OneEuroSettings settings{1.0, 3.0, 1.0};
  std::optional<FilteredRotation> state;
  for (int i = 0; i < 200; ++i) state = filter(settings, state, yaw(0.02 * i), kStart + milliseconds(33) * i);
  // A share a of what is left is made up in each step of 0.033 s, so 0.02 / a rad are left before it, and that is the
  // speed. With a cut-off of 1 + 3 times the speed, a = 0.493.
  EXPECT_NEAR(state->speed.norm(), 0.02 / 0.493 / 0.033, 0.01);
  EXPECT_NEAR(state->value.angularDistance(yaw(0.02 * 199)), 0.02 / 0.493 - 0.02, 0.001);
}

}  // namespace
}  // namespace cyclorama::tracker
