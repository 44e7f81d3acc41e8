// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/governor/frame_time_model.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace cyclorama::governor {
namespace {

/// A farm with a fixed time, and a slope from thread times to wall time.
struct Farm {
  double fixed_ms = 10.0;
  double slope = 1.2;
  double rays_per_work = 3.0;
  bool has_rays = true;
  [[nodiscard]] double ms(double work) const { return fixed_ms + slope * rays_per_work * work; }
  [[nodiscard]] MeasuredFrame frame(double work) const {
    return {work, ms(work), has_rays ? rays_per_work * work : 0.0};
  }
};

TEST(FrameTimeModel, tells_fixed_time_from_rate_once_two_works_were_seen) {
  for (const bool has_rays : {true, false}) {
    const Farm farm{.has_rays = has_rays};
    FrameTimeModel model;
    for (int i = 0; i < 40; ++i) model.add(farm.frame(i % 2 == 0 ? 1.0 : 4.0));
    EXPECT_NEAR(model.ms_of(10.0), farm.ms(10.0), 0.02 * farm.ms(10.0)) << has_rays;
    EXPECT_NEAR(model.fixed_ms(), farm.fixed_ms, 0.5) << has_rays;
    EXPECT_NEAR(model.work_within(50.0), 40.0 / 3.6, 0.3) << has_rays;
  }
}

TEST(FrameTimeModel, learns_the_split_of_one_work_from_thread_times) {
  const Farm farm{.slope = 1.0};
  FrameTimeModel model;
  for (int i = 0; i < 10; ++i) model.add(farm.frame(1.0));
  EXPECT_NEAR(model.fixed_ms(), 10.0, 0.5);
  EXPECT_NEAR(model.ms_of(10.0), 40.0, 2.0);
}

TEST(FrameTimeModel, takes_thread_times_that_come_later) {
  Farm farm{.slope = 1.0, .has_rays = false};
  FrameTimeModel model;
  model.add(farm.frame(1.0));
  farm.has_rays = true;
  for (int i = 0; i < 40; ++i) model.add(farm.frame(i % 2 == 0 ? 1.0 : 4.0));
  EXPECT_NEAR(model.ms_of(10.0), farm.ms(10.0), 0.02 * farm.ms(10.0));
  farm.rays_per_work *= 3.0;
  model.add(farm.frame(4.0));
  EXPECT_NEAR(model.ms_of(10.0), farm.ms(10.0), 0.05 * farm.ms(10.0));
}

TEST(FrameTimeModel, does_not_promise_what_it_cannot_know) {
  const Farm farm{.fixed_ms = 0.0, .has_rays = false};
  FrameTimeModel model;
  for (int i = 0; i < 100; ++i) model.add(farm.frame(1.0));
  EXPECT_GT(model.sd_ms(5.0), 10.0 * model.sd_ms(1.0)) << "only one work was seen";
  EXPECT_NEAR(model.work_surely_within(10.0), 10.0 / 3.6, 0.1) << "as if nothing were fixed";
  EXPECT_LE(model.work_surely_within(1000.0), 5.0) << "five times the last work";
}

TEST(FrameTimeModel, never_promises_more_than_fits_whatever_part_is_fixed) {
  for (const double fixed_ms : {0.0, 2.0, 10.0, 30.0}) {
    const Farm farm{.fixed_ms = fixed_ms, .has_rays = false};
    FrameTimeModel model;
    for (int i = 0; i < 20; ++i) {
      const double work = i == 0 ? 0.1 : model.work_surely_within(50.0);
      EXPECT_LE(farm.ms(work), 50.5) << fixed_ms;
      model.add(farm.frame(work));
    }
    EXPECT_GT(farm.ms(model.work_surely_within(50.0)), 45.0) << fixed_ms;
  }
}

TEST(FrameTimeModel, leaves_out_one_frame_that_hung_and_follows_two) {
  const Farm farm{.has_rays = false};
  FrameTimeModel model;
  for (int i = 0; i < 100; ++i) model.add(farm.frame(i % 2 == 0 ? 3.0 : 4.0));
  const double before = model.ms_of(4.0);
  MeasuredFrame hung = farm.frame(4.0);
  hung.ms *= 5.0;
  model.add(hung);
  EXPECT_NEAR(model.ms_of(4.0), before, 0.01 * before);
  model.add(hung);
  EXPECT_GT(model.ms_of(4.0), 3.5 * before);
  for (int i = 0; i < 10; ++i) model.add(farm.frame(4.0));
  EXPECT_NEAR(model.ms_of(4.0), before, 0.1 * before);
}

TEST(FrameTimeModel, follows_a_scene_that_becomes_more_expensive_after_one_frame_and_a_cheaper_one_after_two) {
  Farm farm;
  FrameTimeModel model;
  for (int i = 0; i < 100; ++i) model.add(farm.frame(i % 2 == 0 ? 3.0 : 4.0));
  farm.rays_per_work *= 3.0;
  model.add(farm.frame(4.0));
  EXPECT_NEAR(model.ms_of(4.0), farm.ms(4.0), 0.05 * farm.ms(4.0));
  EXPECT_NEAR(model.fixed_ms(), farm.fixed_ms, 1.0) << "it is the scene, not the network";
  farm.rays_per_work /= 3.0;
  model.add(farm.frame(4.0));
  model.add(farm.frame(4.0));
  EXPECT_NEAR(model.ms_of(4.0), farm.ms(4.0), 0.05 * farm.ms(4.0));
}

TEST(FrameTimeModel, measures_the_noise_without_the_frames_that_hung) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal(1.0, 0.08);
  FrameTimeModel model;
  for (int i = 0; i < 2000; ++i) {
    MeasuredFrame frame = Farm{}.frame(4.0);
    frame.ms *= i % 100 == 50 ? 10.0 : normal(random);
    model.add(frame);
  }
  EXPECT_GT(model.noise(), 0.05);
  EXPECT_LT(model.noise(), 0.12);
}

TEST(FrameTimeModel, stays_within_its_bounds_whatever_comes) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  FrameTimeModel model;
  for (const double bad : {0.0, -1.0, kNan, kInfinite}) {
    model.add({bad, 10.0, 5.0});
    model.add({1.0, bad, 5.0});
  }
  EXPECT_FALSE(model.is_known());
  std::mt19937 random(9);
  std::lognormal_distribution<double> any(0.0, 4.0);
  for (int i = 0; i < 20000; ++i) {
    model.add({any(random), any(random), i % 3 == 0 ? kNan : any(random)});
    ASSERT_GE(model.fixed_ms(), 0.0) << i;
    ASSERT_TRUE(std::isfinite(model.ms_of(1.0)) && model.ms_of(1.0) > 0.0) << i;
    ASSERT_TRUE(std::isfinite(model.sd_ms(1.0))) << i;
    ASSERT_TRUE(std::isfinite(model.work_within(50.0)) && model.work_within(50.0) >= 0.0) << i;
    ASSERT_GT(model.noise(), 0.0) << i;
  }
}

}  // namespace
}  // namespace cyclorama::governor
