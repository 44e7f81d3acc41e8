// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/refresh_reporter.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace cyclorama::display {
namespace {

using Light = output::HeadShown::Light;
using std::chrono::milliseconds;

constexpr double kHz = 100.0;

class RefreshReporterTest : public ::testing::Test {
 protected:
  double gauge(const std::string& name) const {
    const wire::ProcessStatus status = inspection_.status();
    const auto found = std::ranges::find_if(status.gauges(), [&](const auto& g) { return g.name() == name; });
    return found == status.gauges().end() ? -1.0 : found->value();
  }
  wire::Stage stage(const std::string& name) const {
    const wire::ProcessStatus status = inspection_.status();
    const auto found = std::ranges::find_if(status.stages(), [&](const auto& s) { return s.name() == name; });
    return found == status.stages().end() ? wire::Stage{} : *found;
  }
  void shown(std::size_t head, milliseconds at, Light light = Light::kNew) {
    reporter_.take({head, {light, kStart + at, kHz}, kStart});
  }

  static constexpr TimePoint kStart{std::chrono::hours(1)};
  InspectionService inspection_{"display"};
  RefreshReporter reporter_{&inspection_, {"left", "right"}};
};

TEST_F(RefreshReporterTest, reports_the_pacing_of_each_head) {
  for (int n = 0; n < 100; ++n) shown(0, milliseconds(10 * n));
  for (int n = 0; n < 50; ++n) shown(1, milliseconds(20 * n));
  const wire::Stage left = stage("refresh_interval: left");
  EXPECT_EQ(left.count(), 99U);
  EXPECT_NEAR(left.p50_ms(), 10.0, 1e-6);
  EXPECT_NEAR(left.p99_ms(), 10.0, 1e-6);
  EXPECT_EQ(gauge("missed_refreshes: left"), 0.0);
  EXPECT_NEAR(stage("refresh_interval: right").p50_ms(), 20.0, 1e-6);
  EXPECT_EQ(gauge("missed_refreshes: right"), 49.0);
  EXPECT_EQ(gauge("late_refreshes: right"), 0.0);
  shown(0, milliseconds(1003));
  EXPECT_EQ(gauge("late_refreshes: left"), 1.0);
}

TEST_F(RefreshReporterTest, reports_the_age_of_pictures) {
  for (int n = 1; n <= 100; ++n) shown(0, milliseconds(10 * n));
  EXPECT_NEAR(stage("picture_age: left").p50_ms(), 500.0, 1e-6);
  EXPECT_NEAR(stage("picture_age: left").p99_ms(), 990.0, 1e-6);
  EXPECT_EQ(stage("picture_age: right").count(), 0U);
}

TEST_F(RefreshReporterTest, reports_which_heads_are_lit_and_ignores_the_pacing_of_dark_ones) {
  EXPECT_EQ(gauge("lit: left"), 0.0);
  shown(0, milliseconds(10));
  shown(1, milliseconds(10), Light::kDark);
  EXPECT_EQ(gauge("lit: left"), 1.0);
  EXPECT_EQ(gauge("lit: right"), 0.0);
  shown(0, milliseconds(20), Light::kSame);
  EXPECT_EQ(gauge("lit: left"), 1.0);
  shown(0, milliseconds(500));
  reporter_.output_lost();
  EXPECT_EQ(gauge("lit: left"), 0.0);
  shown(0, milliseconds(9000));
  EXPECT_EQ(stage("refresh_interval: left").count(), 0U);
  EXPECT_EQ(gauge("missed_refreshes: left"), 0.0);
}

TEST_F(RefreshReporterTest, counts_refreshes_with_another_pose_than_the_one_before) {
  RefreshEvent event;
  for (int n = 0; n < 6; ++n) {
    event.eye_m.x() = 0.1 * (n / 2);
    event.heading_rad = n < 5 ? 0.0 : 0.1;
    reporter_.take(event);
  }
  EXPECT_EQ(gauge("poses_shown"), 3.0);
}

}  // namespace
}  // namespace cyclorama::display
