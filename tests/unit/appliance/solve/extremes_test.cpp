// SPDX-License-Identifier: Apache-2.0
/// The ends of each sweep of `./bench.sh calibration-extremes`, once each: refused with a remedy, or correct; never
/// NaN.
#include <gtest/gtest.h>

#include <cctype>
#include <cmath>
#include <functional>
#include <string>

#include "appliance/solve/calibrate.h"
#include "tests/data_sets/generated_room.h"

namespace cyclorama::solve {
namespace {

constexpr double kDegree = 0.017453292519943295;

struct End {
  const char* name;
  std::function<void(RoomPlan*)> change;
  double bound_px = 0.8;  ///< Bound of the registration's p95.
  bool may_refuse = false;
};

const End kEnds[] = {
    {"arc of 2 degrees",
     [](RoomPlan* plan) {
       plan->arc_rad = 2.0 * kDegree;
       plan->projectors = 2;
       plan->half_height_m = 0.06;
       plan->turntable_step_rad = 0.05;
     }},
    {"arc of 360 degrees",
     [](RoomPlan* plan) {
       plan->arc_rad = 360.0 * kDegree;
       plan->projectors = 8;
       plan->turntable_step_rad = 0.5;
       plan->stride_px = 24;
     }},
    {"throw 0.25",
     [](RoomPlan* plan) {
       plan->throw_ratio = 0.25;
       plan->stride_px = 10;  // With fewer points the cells would be too large for its curved map.
     }},
    {"throw 8",
     [](RoomPlan* plan) {
       plan->throw_ratio = 8.0;
       plan->arc_rad = 0.6;
     }},
    {"incidence of 85 degrees",
     [](RoomPlan* plan) {
       plan->kind = RoomKind::kPlane;
       plan->arc_rad = 0.8;
       plan->throw_ratio = 1.2;
       plan->projectors = 2;
       plan->aim_off_rad = std::tan(85.0 * kDegree);
     },
     1.0},
    {"overlap of 2 %", [](RoomPlan* plan) { plan->overlap = 0.02; }},
    {"overlap of 60 %", [](RoomPlan* plan) { plan->overlap = 0.6; }},
    {"nodal offset of 0 mm", [](RoomPlan* plan) { plan->camera_offset_m.setZero(); }},
    {"nodal offset of 50 mm",
     [](RoomPlan* plan) {
       plan->camera_offset_m = {0.02, 0.0, 0.045};
     }},
    {"turntable step of 3 degrees",
     [](RoomPlan* plan) {
       plan->turntable_step_rad = 3.0 * kDegree;
       plan->arc_rad = 0.6;
       plan->stride_px = 32;
     }},
    {"turntable step of 180 degrees", [](RoomPlan* plan) { plan->turntable_step_rad = 180.0 * kDegree; }, 0.8, true},
    {"camera of 0.3 megapixels",
     [](RoomPlan* plan) {
       plan->camera_megapixels = 0.3;
       plan->noise_px = 0.55;
     }},
    {"camera of 20 megapixels",
     [](RoomPlan* plan) {
       plan->camera_megapixels = 20.0;
       plan->noise_px = 0.07;
     }},
    {"a person walking through", [](RoomPlan* plan) { plan->person_rad = 0.2; }},
    {"5 % gross errors", [](RoomPlan* plan) { plan->outliers = 0.05; }},
};

class Extremes : public testing::TestWithParam<End> {};

TEST_P(Extremes, are_solved_correctly_or_refused_with_a_remedy) {
  RoomPlan plan;
  plan.stride_px = 14;
  GetParam().change(&plan);
  const GeneratedRoom room(plan);
  const Measurements measured = room.measurements();
  CalibrateOptions options;
  options.with_wall = false;
  const auto calibration = calibrate(measured, "2026-01-01T00-00-00Z", options);
  if (!calibration) {
    EXPECT_TRUE(GetParam().may_refuse) << calibration.error().message();
    EXPECT_NE(calibration.error().message().find("; "), std::string::npos) << calibration.error().message();
    return;
  }
  EXPECT_TRUE(calibration->turntable.covariance.allFinite());
  for (const calibration::CalibratedProjector& p : calibration->projectors) {
    for (std::size_t i = 0; i < p.map.directions.size(); ++i) {
      EXPECT_EQ(p.map.directions[i].allFinite(), std::isfinite(p.map.sigma_px[i]));
    }
  }
  const RegistrationScore score = registration_score(
      room, [&](std::size_t p, const Eigen::Vector2d& px) { return calibration->projectors[p].map.direction_at(px); });
  EXPECT_GT(score.correspondences, 20U);
  EXPECT_LE(score.p95_px, GetParam().bound_px) << calibration->turntable.offset_reason;
}

std::string name_of_end(const testing::TestParamInfo<End>& end) {
  std::string name;
  for (const char c : std::string(end.param.name)) name += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  return name;
}

INSTANTIATE_TEST_SUITE_P(Ends, Extremes, testing::ValuesIn(kEnds), name_of_end);

}  // namespace
}  // namespace cyclorama::solve
