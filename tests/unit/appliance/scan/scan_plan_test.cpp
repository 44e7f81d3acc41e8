// SPDX-License-Identifier: Apache-2.0
#include "appliance/scan/scan_plan.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <numbers>

#include "appliance/scan/wall_scan.h"
#include "drivers/simulated/museum/presets.h"

namespace cyclorama::scan {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kDegree = std::numbers::pi / 180.0;

Installation room(const char* name, int projectors = 3) {
  simulated::PresetOptions options;
  options.projectors = projectors;
  return simulated::make_preset(name, 1, options)->installation;
}

ScanPlanOptions camera_of(double field_deg, double pitch_deg = 0.0) {
  ScanPlanOptions options;
  options.camera = data_sheet_lens(1600, 1200, field_deg * kDegree);
  options.pitch_rad = pitch_deg * kDegree;
  return options;
}

TEST(ScanPlan, sees_every_projector_from_two_or_more_directions) {
  for (const std::string& name : simulated::preset_names()) {
    const bool is_dome = name == "dome";
    const auto plan = plan_scan(room(name.c_str()), camera_of(is_dome ? 92.0 : 70.0, is_dome ? 25.0 : 0.0));
    ASSERT_TRUE(plan.has_value()) << name << ": " << plan.error().message();
    EXPECT_GE(plan->directions.size(), 2u) << name;
    EXPECT_LE(plan->directions.size(), 5u) << name;
    for (std::size_t p = 0; p < 3; ++p) {
      const auto sees = [&](const ScanDirection& d) {
        return std::find(d.projectors.begin(), d.projectors.end(), p) != d.projectors.end();
      };
      EXPECT_GE(std::count_if(plan->directions.begin(), plan->directions.end(), sees), 1) << name;
    }
    EXPECT_NEAR(plan->wall_distance_m, 4.2, 1.2) << name;
  }
}

TEST(ScanPlan, uses_more_directions_with_a_narrower_lens) {
  std::size_t before = 1;
  for (const double field_deg : {100.0, 70.0, 45.0, 32.0}) {
    const auto plan = plan_scan(room("cylinder126"), camera_of(field_deg));
    ASSERT_TRUE(plan.has_value()) << plan.error().message();
    EXPECT_GE(plan->directions.size(), before) << field_deg;
    before = plan->directions.size();
    for (std::size_t i = 1; i < plan->directions.size(); ++i) {
      const double step = plan->directions[i].angle_rad - plan->directions[i - 1].angle_rad;
      EXPECT_GT(step, 0.0);
      EXPECT_LT(step, 0.75 * field_deg * kDegree) << "neighbours overlap";
    }
  }
  EXPECT_GE(before, 4u);
}

TEST(ScanPlan, uses_the_requested_number_of_directions) {
  ScanPlanOptions options = camera_of(70.0);
  options.directions = 6;
  const auto plan = plan_scan(room("cylinder126"), options);
  ASSERT_TRUE(plan.has_value()) << plan.error().message();
  EXPECT_EQ(plan->directions.size(), 6u);
}

TEST(ScanPlan, stays_within_the_turntables_range_and_reports_what_is_not_seen) {
  ScanPlanOptions options = camera_of(70.0);
  options.range = {-0.4, 0.4};
  const auto plan = plan_scan(room("cylinder126", 4), options);
  ASSERT_TRUE(plan.has_value()) << plan.error().message();
  for (const ScanDirection& direction : plan->directions) EXPECT_LE(std::abs(direction.angle_rad), 0.4 + 1e-6);
  ASSERT_FALSE(plan->remarks.empty());
  EXPECT_THAT(plan->remarks.front(), HasSubstr("wider"));
}

TEST(ScanPlan, refuses_a_camera_that_looks_elsewhere_with_a_remedy) {
  const auto up = plan_scan(room("cylinder126"), camera_of(40.0, 80.0));
  ASSERT_FALSE(up.has_value());
  EXPECT_EQ(up.error().code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(up.error().message(), HasSubstr("tilt"));
  ScanPlanOptions fixed = camera_of(70.0);
  fixed.range = {0.0, 0.0};
  const auto one = plan_scan(room("cylinder126"), fixed);
  ASSERT_FALSE(one.has_value());
  EXPECT_THAT(one.error().message(), HasSubstr("; "));
}

TEST(ScanPlan, assigns_no_projector_to_a_direction_that_does_not_see_it) {
  const auto plan = plan_scan(room("cylinder126", 4), camera_of(50.0));
  ASSERT_TRUE(plan.has_value());
  const auto& first = plan->directions.front().projectors;
  EXPECT_EQ(std::find(first.begin(), first.end(), 3u), first.end());
}

}  // namespace
}  // namespace cyclorama::scan
