// SPDX-License-Identifier: Apache-2.0
#include "appliance/solve/turntable.h"

#include <ceres/cost_function.h>
#include <ceres/gradient_checker.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "appliance/solve/map_fit.h"
#include "appliance/solve/turntable_adjustment.h"
#include "tests/data_sets/generated_room.h"

namespace cyclorama::solve {
namespace {

RoomPlan coarse_plan() {
  RoomPlan plan;
  plan.stride_px = 12;
  return plan;
}

Result<calibration::CalibratedTurntable> solved(const Measurements& measured,
                                                const TurntableSolverOptions& options = {}) {
  return solve_turntable(measured, average_cells(measured, fitting_cell_px(measured)), options);
}

/// The residuals of one observation in the form that Ceres' gradient checker needs. Blocks: lens, mount, offset, angle,
/// direction, inverse depth.
class ObservationCost : public ceres::CostFunction {
 public:
  explicit ObservationCost(const CellMean& seen) : observation_(seen) {
    set_num_residuals(2);
    *mutable_parameter_block_sizes() = {calibration::MeasuredLens::kParameters, 2, 2, 1, 3,
                                        calibration::kInverseDepthTerms};
  }
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    calibration::InverseDepthTerms terms{};
    std::copy_n(blocks[5], terms.size(), terms.begin());
    const SeenFrom camera({blocks[1][0], blocks[1][1]}, {blocks[2][0], blocks[2][1]}, blocks[3][0]);
    Eigen::Vector2d errors;
    SeenFrom::Slopes slopes;
    if (!camera.residuals(observation_, blocks[0], terms, 0.03, Eigen::Vector3d(blocks[4]), &errors, &slopes))
      return false;
    Eigen::Map<Eigen::Vector2d>(residuals, 2) = errors;
    if (jacobians == nullptr) return true;
    const auto put = [&](int block, const auto& columns) {
      using Rows = Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::RowMajor>;
      if (jacobians[block] != nullptr) Eigen::Map<Rows>(jacobians[block], 2, columns.cols()) = columns;
    };
    put(0, slopes.by_numbers.middleCols(kLensIndex, calibration::MeasuredLens::kParameters));
    put(1, slopes.by_numbers.middleCols(kMountIndex, 2));
    put(2, slopes.by_numbers.middleCols(kOffsetIndex, 2));
    put(3, slopes.by_numbers.middleCols(kAngleIndex, 1));
    put(4, slopes.by_direction);
    put(5, slopes.by_numbers.middleCols(kInverseDepthIndex, calibration::kInverseDepthTerms));
    return true;
  }

 private:
  TurntableObservation observation_;
};

TEST(TurntableCost, has_the_jacobian_of_differences) {
  CellMean seen;
  seen.camera_px = {900.0, 500.0};
  seen.camera_per_projector << 0.6, 0.02, -0.03, 0.55;
  seen.sigma_px = 0.1;
  const ObservationCost cost(seen);
  std::vector<double> lens{1400.0, 960.0, 600.0, -0.1, 0.02, 0.001, 1e-3, -1e-3};
  std::vector<double> mount{0.05, -0.03};
  std::vector<double> offset{0.01, 0.02};
  std::vector<double> angle{0.4};
  Eigen::Vector3d d = Eigen::Vector3d(0.45, 0.1, -0.85).normalized();
  std::vector<double> inverse_depth{0.25, 0.01, 0.02, -0.03, 0.01, 0.0, 0.02, 0.01, -0.01};
  const double* blocks[] = {lens.data(), mount.data(), offset.data(), angle.data(), d.data(), inverse_depth.data()};
  ceres::NumericDiffOptions steps;
  const ceres::GradientChecker checker(&cost, static_cast<const std::vector<const ceres::Manifold*>*>(nullptr), steps);
  ceres::GradientChecker::ProbeResults results;
  EXPECT_TRUE(checker.Probe(blocks, 1e-5, &results)) << results.error_log;
}

/// Compares the problem's gradient with finite differences of its cost, including the sums over directions and the
/// elimination of tracks.
TEST(TurntableAdjustment, reaches_a_minimum_over_all_shared_parameters) {
  const Measurements measured = GeneratedRoom(coarse_plan()).measurements();
  const CellMeans means = average_cells(measured, fitting_cell_px(measured));
  const auto tracks = choose_tracks(measured, means, 300, 5);
  ASSERT_TRUE(tracks) << tracks.error().message();
  const TurntableSolverOptions options;
  const TurntableTask task{measured, means, options, *tracks, 1};
  const auto plain = solve_turntable_problem(task, {}, nullptr, Eigen::Vector2d::Zero());
  ASSERT_TRUE(plain) << plain.error().message();
  const auto solved = solve_turntable_problem(task, {}, &plain->state, Eigen::Vector2d::Zero());
  ASSERT_TRUE(solved) << solved.error().message();
  EXPECT_LE(solved->cost, plain->cost * 1.001);
  std::vector<const Track*> used;
  for (const Track& track : tracks->used) used.push_back(&track);
  ASSERT_EQ(used.size(), solved->state.directions.size());
  const auto cost_of = [&](TurntableState state) {
    TurntableAdjustment adjustment(task, {}, true, used, &state);
    adjustment.weigh_by(RobustLoss::kCauchy);
    return adjustment.linearise().value_or(1e9);
  };
  EXPECT_NEAR(cost_of(solved->state), solved->cost, 1e-6 * solved->cost);
  for (const double aside : {1e-4, -1e-4}) {
    TurntableState tilted = solved->state;
    tilted.mount[0] += aside;
    EXPECT_GT(cost_of(tilted), solved->cost);
    TurntableState moved = solved->state;
    moved.offset[1] += 10.0 * aside;
    EXPECT_GT(cost_of(moved), solved->cost);
    TurntableState turned = solved->state;
    turned.angles[0] += aside;
    EXPECT_GT(cost_of(turned), solved->cost);
    TurntableState zoomed = solved->state;
    zoomed.lens[calibration::MeasuredLens::kFocal] *= 1.0 + aside;
    EXPECT_GT(cost_of(zoomed), solved->cost);
  }
  EXPECT_EQ(static_cast<Eigen::Index>(solved->names.size()), solved->covariance.rows());
  const Eigen::MatrixXd information = [&] {
    TurntableState state = solved->state;
    TurntableAdjustment adjustment(task, {}, true, used, &state);
    adjustment.weigh_by(RobustLoss::kCauchy);
    return adjustment.reduced_normal(false);
  }();
  const Eigen::MatrixXd product = information.selfadjointView<Eigen::Lower>() * solved->covariance;
  const Eigen::VectorXd scale = solved->covariance.diagonal().cwiseSqrt();
  const Eigen::MatrixXd scaled = scale.cwiseInverse().asDiagonal() * product.transpose() * scale.asDiagonal();
  EXPECT_LE((scaled - Eigen::MatrixXd::Identity(scaled.rows(), scaled.cols())).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(TurntableSolve, recovers_axis_offset_and_angles_within_its_stated_uncertainty) {
  RoomPlan plan = coarse_plan();
  plan.camera_offset_m = {0.008, 0.0, 0.015};
  const Measurements measured = GeneratedRoom(plan).measurements();
  const auto turntable = solved(measured);
  ASSERT_TRUE(turntable) << turntable.error().message();
  EXPECT_TRUE(turntable->is_offset_estimated) << turntable->offset_reason;
  EXPECT_NEAR(turntable->offset_m.x(), 0.008, 0.003) << turntable->offset_reason;
  EXPECT_NEAR(turntable->offset_m.y(), 0.015, 0.005) << turntable->offset_reason;
  EXPECT_LE(turntable->heldout_rms_px, 0.15);
  EXPECT_EQ(static_cast<Eigen::Index>(turntable->parameters.size()), turntable->covariance.rows());
  EXPECT_TRUE(turntable->covariance.allFinite());
}

TEST(TurntableSolve, takes_an_unobservable_offset_as_zero) {
  RoomPlan plan = coarse_plan();
  plan.camera_offset_m.setZero();
  const auto turntable = solved(GeneratedRoom(plan).measurements());
  ASSERT_TRUE(turntable) << turntable.error().message();
  EXPECT_LE(turntable->offset_m.norm(), 0.004) << turntable->offset_reason;
}

TEST(TurntableSolve, converges_from_another_start) {
  const Measurements measured = GeneratedRoom(coarse_plan()).measurements();
  const auto one = solved(measured);
  TurntableSolverOptions elsewhere;
  elsewhere.start = {0.08, -0.06, 0.02, -0.02};
  const auto other = solved(measured, elsewhere);
  ASSERT_TRUE(one && other);
  for (const double u : {300.0, 960.0, 1600.0}) {
    const auto a = seen_direction(*one, 1, {u, 500.0});
    const auto b = seen_direction(*other, 1, {u, 500.0});
    ASSERT_TRUE(a && b);
    EXPECT_LE((*a - *b).norm(), 2e-5) << one->offset_reason << "\n" << other->offset_reason;
  }
}

TEST(TurntableSolve, refuses_a_single_direction_and_names_what_to_add) {
  Measurements measured = GeneratedRoom(coarse_plan()).measurements();
  measured.directions.resize(1);
  const auto turntable = solved(measured);
  ASSERT_FALSE(turntable);
  EXPECT_EQ(turntable.error().code(), ErrorCode::kInvalidArgument);
  EXPECT_NE(turntable.error().message().find("add a direction"), std::string::npos) << turntable.error().message();
}

TEST(TurntableSolve, refuses_directions_without_common_points_and_names_the_gap) {
  RoomPlan plan = coarse_plan();
  plan.arc_rad = 3.0;
  plan.turntable_step_rad = 1.5;
  const auto turntable = solved(GeneratedRoom(plan).measurements());
  ASSERT_FALSE(turntable);
  EXPECT_EQ(turntable.error().code(), ErrorCode::kInvalidArgument);
  EXPECT_NE(turntable.error().message().find("degrees"), std::string::npos) << turntable.error().message();
}

TEST(TurntableSolve, refuses_angles_with_the_wrong_sign) {
  Measurements measured = GeneratedRoom(coarse_plan()).measurements();
  for (TurntableDirection& direction : measured.directions) direction.angle_rad = -direction.angle_rad;
  EXPECT_FALSE(solved(measured));
}

TEST(Measurements, refuses_nan_by_its_position) {
  Measurements measured = GeneratedRoom(coarse_plan()).measurements();
  measured.directions[1].correspondences[7].camera_u = std::nanf("");
  const auto status = measured.validate();
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().message().find("direction 1, correspondence 7"), std::string::npos);
}

TEST(Registration, is_within_a_quarter_pixel_without_a_wall_model) {
  const GeneratedRoom room(coarse_plan());
  const Measurements measured = room.measurements();
  const CellMeans means = average_cells(measured, fitting_cell_px(measured));
  const auto turntable = solve_turntable(measured, means);
  ASSERT_TRUE(turntable) << turntable.error().message();
  std::vector<std::vector<MapSample>> samples(room.projectors());
  for (const CellMean& cell : means.cells) {
    const auto d = seen_direction(*turntable, static_cast<std::size_t>(cell.direction), cell.camera_px);
    if (d) samples[static_cast<std::size_t>(cell.projector)].push_back({cell.projector_px, *d, cell.sigma_px});
  }
  std::vector<calibration::MeasuredMap> maps;
  for (const auto& of_projector : samples) {
    auto map = fit_measured_map(1920, 1080, of_projector);
    ASSERT_TRUE(map) << map.error().message();
    maps.push_back(*std::move(map));
  }
  const auto score =
      registration_score(room, [&](std::size_t p, const Eigen::Vector2d& px) { return maps[p].direction_at(px); });
  EXPECT_GT(score.correspondences, 200U);
  EXPECT_LE(score.mean_px, 0.25);
  EXPECT_LE(score.p95_px, 0.6);
  EXPECT_LE(score.max_px, 1.0);
  EXPECT_LE(score.true_p95_px, 1.5);
}

}  // namespace
}  // namespace cyclorama::solve
