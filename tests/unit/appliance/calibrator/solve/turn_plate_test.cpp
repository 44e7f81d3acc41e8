// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibrator/solve/turn_plate.h"

#include <ceres/cost_function.h>
#include <ceres/gradient_checker.h>
#include <gtest/gtest.h>

#include <cmath>

#include "appliance/calibrator/solve/measured_map.h"
#include "tests/doubles/generated_room.h"

namespace cyclorama {
namespace {

RoomPlan coarse_plan() {
  RoomPlan plan;
  plan.stride_px = 12;
  return plan;
}

Result<TurnPlate> solved(const Measurements& measured, const TurnPlateOptions& options = {}) {
  return solve_turn_plate(measured, average_cells(measured, fitting_cell_px(measured)), options);
}

TEST(PlateCost, has_the_jacobian_that_differences_give) {
  CellMean seen;
  seen.camera_px = {900.0, 500.0};
  seen.camera_per_projector << 0.6, 0.02, -0.03, 0.55;
  seen.sigma_px = 0.1;
  const auto cost = make_sight_cost(seen);
  std::vector<double> lens{1400.0, 960.0, 600.0, -0.1, 0.02, 0.001, 1e-3, -1e-3};
  std::vector<double> mount{0.05, -0.03};
  std::vector<double> offset{0.01, 0.02};
  std::vector<double> angle{0.4};
  Eigen::Vector3d d = Eigen::Vector3d(0.45, 0.1, -0.85).normalized();
  std::vector<double> nearness{0.25, 0.01, 0.02, -0.03, 0.01, 0.0, 0.02, 0.01, -0.01};
  const double* blocks[] = {lens.data(), mount.data(), offset.data(), angle.data(), d.data(), nearness.data()};
  ceres::NumericDiffOptions steps;
  const ceres::GradientChecker checker(cost.get(), static_cast<const std::vector<const ceres::Manifold*>*>(nullptr),
                                       steps);
  ceres::GradientChecker::ProbeResults results;
  EXPECT_TRUE(checker.Probe(blocks, 1e-5, &results)) << results.error_log;
}

TEST(TurnPlate, finds_axis_offset_and_angles_within_what_it_claims) {
  RoomPlan plan = coarse_plan();
  plan.camera_offset_m = {0.008, 0.0, 0.015};
  const Measurements measured = GeneratedRoom(plan).measurements();
  const auto plate = solved(measured);
  ASSERT_TRUE(plate) << plate.error().message();
  EXPECT_TRUE(plate->is_offset_estimated) << plate->offset_reason;
  EXPECT_NEAR(plate->offset_m.x(), 0.008, 0.003) << plate->offset_reason;
  EXPECT_NEAR(plate->offset_m.y(), 0.015, 0.005) << plate->offset_reason;
  EXPECT_LE(plate->heldout_rms_px, 0.15);
  EXPECT_EQ(static_cast<Eigen::Index>(plate->parameters.size()), plate->covariance.rows());
  EXPECT_TRUE(plate->covariance.allFinite());
}

TEST(TurnPlate, takes_an_offset_that_cannot_be_seen_for_none) {
  RoomPlan plan = coarse_plan();
  plan.camera_offset_m.setZero();
  const auto plate = solved(GeneratedRoom(plan).measurements());
  ASSERT_TRUE(plate) << plate.error().message();
  EXPECT_LE(plate->offset_m.norm(), 0.004) << plate->offset_reason;
}

TEST(TurnPlate, starts_elsewhere_and_comes_to_the_same) {
  const Measurements measured = GeneratedRoom(coarse_plan()).measurements();
  const auto one = solved(measured);
  TurnPlateOptions elsewhere;
  elsewhere.start = {0.08, -0.06, 0.02, -0.02};
  const auto other = solved(measured, elsewhere);
  ASSERT_TRUE(one && other);
  for (const double u : {300.0, 960.0, 1600.0}) {
    const auto a = one->sight_of(1, {u, 500.0});
    const auto b = other->sight_of(1, {u, 500.0});
    ASSERT_TRUE(a && b);
    EXPECT_LE((*a - *b).norm(), 2e-5) << one->offset_reason << "\n" << other->offset_reason;
  }
}

TEST(TurnPlate, refuses_one_direction_and_says_what_to_add) {
  Measurements measured = GeneratedRoom(coarse_plan()).measurements();
  measured.directions.resize(1);
  const auto plate = solved(measured);
  ASSERT_FALSE(plate);
  EXPECT_EQ(plate.error().code(), ErrorCode::kInvalidArgument);
  EXPECT_NE(plate.error().message().find("add a direction"), std::string::npos) << plate.error().message();
}

TEST(TurnPlate, refuses_directions_that_share_nothing_and_names_the_gap) {
  RoomPlan plan = coarse_plan();
  plan.arc_rad = 3.0;
  plan.plate_step_rad = 1.5;
  const auto plate = solved(GeneratedRoom(plan).measurements());
  ASSERT_FALSE(plate);
  EXPECT_EQ(plate.error().code(), ErrorCode::kInvalidArgument);
  EXPECT_NE(plate.error().message().find("degrees"), std::string::npos) << plate.error().message();
}

TEST(TurnPlate, refuses_angles_that_count_the_wrong_way) {
  Measurements measured = GeneratedRoom(coarse_plan()).measurements();
  for (PlateDirection& direction : measured.directions) direction.angle_rad = -direction.angle_rad;
  EXPECT_FALSE(solved(measured));
}

TEST(Measurements, that_are_no_numbers_are_refused_by_their_place) {
  Measurements measured = GeneratedRoom(coarse_plan()).measurements();
  measured.directions[1].correspondences[7].camera_u = std::nanf("");
  const auto status = measured.validate();
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().message().find("direction 1, correspondence 7"), std::string::npos);
}

TEST(Registration, of_maps_that_no_screen_model_helped_is_within_a_quarter_pixel) {
  const GeneratedRoom room(coarse_plan());
  const Measurements measured = room.measurements();
  const CellMeans means = average_cells(measured, fitting_cell_px(measured));
  const auto plate = solve_turn_plate(measured, means);
  ASSERT_TRUE(plate) << plate.error().message();
  std::vector<std::vector<MapSample>> samples(room.projectors());
  for (const CellMean& cell : means.cells) {
    const auto d = plate->sight_of(static_cast<std::size_t>(cell.direction), cell.camera_px);
    if (d) samples[static_cast<std::size_t>(cell.projector)].push_back({cell.projector_px, *d, cell.sigma_px});
  }
  std::vector<MeasuredMap> maps;
  for (const auto& of_projector : samples) {
    auto map = fit_measured_map(1920, 1080, of_projector);
    ASSERT_TRUE(map) << map.error().message();
    maps.push_back(*std::move(map));
  }
  const auto score =
      registration_score(room, [&](std::size_t p, const Eigen::Vector2d& px) { return maps[p].direction_at(px); });
  EXPECT_GT(score.places, 200U);
  EXPECT_LE(score.mean_px, 0.25);
  EXPECT_LE(score.p95_px, 0.6);
  EXPECT_LE(score.max_px, 1.0);
  EXPECT_LE(score.true_p95_px, 1.5);
}

}  // namespace
}  // namespace cyclorama
