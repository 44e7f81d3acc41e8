// SPDX-License-Identifier: Apache-2.0
#include "appliance/solve/model_selection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/data_sets/generated_room.h"

namespace cyclorama::solve {
namespace {

struct Given {
  std::vector<MeasuredProjector> projectors;
  std::vector<MapSample> samples;
  double distance_m = 4.0;
};

/// Samples from exact camera poses: true directions, noisy pixels.
Given given(RoomKind kind, unsigned seed, double radius_m = 4.0, double arc_rad = 2.0) {
  RoomPlan plan;
  plan.kind = kind;
  plan.seed = seed;
  plan.arc_rad = kind == RoomKind::kPlane || kind == RoomKind::kCorner ? 1.3 : arc_rad;
  plan.stride_px = 400;  // Coarse, since its own measurements are not used.
  plan.radius_m = radius_m;
  const GeneratedRoom room(plan);
  Given result;
  const Measurements measurements = room.measurements();
  result.projectors = measurements.projectors;
  result.distance_m = measurements.wall_distance_m;
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 0.05);
  for (std::size_t p = 0; p < room.projectors(); ++p) {
    for (int y = 20; y < 1080; y += 80) {
      for (int x = 20; x < 1920; x += 80) {
        const auto d = room.view_direction_of(p, {x + 0.5, y + 0.5});
        if (d) result.samples.push_back({{x + 0.5 + noise(random), y + 0.5 + noise(random)}, *d, 0.07, p});
      }
    }
  }
  return result;
}

calibration::SurfaceModel model_of(RoomKind kind, unsigned seed) {
  const Given g = given(kind, seed);
  const auto choice = choose_model(g.projectors, g.samples, g.distance_m);
  EXPECT_TRUE(choice) << choice.error().message();
  if (!choice) return calibration::SurfaceModel::kMesh;
  for (const calibration::ModelTrial& trial : choice->surfaces) {
    std::printf("  %s %s: %.3f px held out, %.3f px trained, scatter %.4f%s\n", name_of(kind), trial.name.c_str(),
                trial.heldout_rms_px, trial.training_rms_px, trial.scatter, trial.is_usable ? "" : " (not usable)");
  }
  return choice->fit.surface.model;
}

TEST(ModelChoice, finds_the_smallest_wall_model_that_predicts_well) {
  EXPECT_EQ(model_of(RoomKind::kPlane, 1), calibration::SurfaceModel::kPlane);
  EXPECT_EQ(model_of(RoomKind::kCylinder, 1), calibration::SurfaceModel::kCylinder);
  EXPECT_EQ(model_of(RoomKind::kTiltedCylinder, 1), calibration::SurfaceModel::kCylinder);
  EXPECT_EQ(model_of(RoomKind::kDome, 1), calibration::SurfaceModel::kQuadric);
}

TEST(ModelChoice, approximates_walls_that_are_nearly_of_another_shape) {
  EXPECT_EQ(model_of(RoomKind::kUnevenCylinder, 1), calibration::SurfaceModel::kProfile);
  // Two planes are a degenerate quadric: eight parameters describe them exactly, a profile only to its knots.
  EXPECT_THAT(model_of(RoomKind::kCorner, 1),
              testing::AnyOf(calibration::SurfaceModel::kProfile, calibration::SurfaceModel::kQuadric));
  EXPECT_EQ(model_of(RoomKind::kBumpy, 1), calibration::SurfaceModel::kMesh);
}

TEST(ModelChoice, finds_a_profile_where_plane_and_cylinder_fit_one_wall_of_a_corner_only) {
  const Given g = given(RoomKind::kCorner, 7);
  const auto choice = choose_model(g.projectors, g.samples, g.distance_m);
  ASSERT_TRUE(choice) << choice.error().message();
  const auto left_out = [&](calibration::SurfaceModel model) {
    const auto trial = std::ranges::find(choice->surfaces, name_of(model), &calibration::ModelTrial::name);
    return trial == choice->surfaces.end() ? -1.0 : trial->heldout_rms_px;
  };
  EXPECT_GT(left_out(calibration::SurfaceModel::kCylinder), 10.0) << "another corner, that shows nothing";
  EXPECT_LT(left_out(calibration::SurfaceModel::kProfile), 1.0);
  EXPECT_LT(left_out(calibration::SurfaceModel::kQuadric), 0.1);
}

/// Redraws the samples through a lens with decentred elements and a second radial coefficient.
Given through_rich_lenses(Given g) {
  constexpr double kK2 = 0.03;
  constexpr double kP1 = 4e-3;
  constexpr double kP2 = -4e-3;
  for (MapSample& sample : g.samples) {
    const calibration::MeasuredLens& lens = g.projectors[sample.projector].position->lens;
    const double focal = lens.values[calibration::MeasuredLens::kFocal];
    const Eigen::Vector2d centre(lens.values[calibration::MeasuredLens::kCentreU],
                                 lens.values[calibration::MeasuredLens::kCentreV]);
    const Eigen::Vector2d t = (sample.projector_px - centre) / focal;
    sample.projector_px += focal * kK2 * t.squaredNorm() * t.squaredNorm() * t;
    sample.projector_px.x() += focal * (2.0 * kP1 * t.x() * t.y() + kP2 * (t.squaredNorm() + 2.0 * t.x() * t.x()));
    sample.projector_px.y() += focal * (kP1 * (t.squaredNorm() + 2.0 * t.y() * t.y()) + 2.0 * kP2 * t.x() * t.y());
  }
  return g;
}

TEST(ModelChoice, does_not_enlarge_the_wall_model_for_the_sake_of_the_lens) {
  for (const auto& [kind, wall] : {std::pair(RoomKind::kPlane, calibration::SurfaceModel::kPlane),
                                   std::pair(RoomKind::kCylinder, calibration::SurfaceModel::kCylinder)}) {
    const Given g = through_rich_lenses(given(kind, 2));
    const auto choice = choose_model(g.projectors, g.samples, g.distance_m);
    ASSERT_TRUE(choice) << choice.error().message();
    EXPECT_EQ(choice->fit.surface.model, wall) << name_of(kind) << ": " << choice->reason;
  }
}

TEST(ModelChoice, never_takes_a_larger_wall_model_that_predicts_worse) {
  const Given g = given(RoomKind::kCylinder, 2);
  const auto choice = choose_model(g.projectors, g.samples, g.distance_m);
  ASSERT_TRUE(choice) << choice.error().message();
  double chosen = -1.0;
  double lesser = 1e9;
  for (const calibration::ModelTrial& trial : choice->surfaces) {
    if (trial.name == name_of(choice->fit.surface.model)) chosen = trial.heldout_rms_px;
    if (chosen < 0.0 && trial.is_usable) lesser = std::min(lesser, trial.heldout_rms_px);
  }
  EXPECT_LE(chosen, lesser);
  EXPECT_NEAR(choice->fit.surface.curvature_per_m() * g.distance_m, 1.0, 0.15);
  EXPECT_EQ(choice->fit.surface_sigmas.size(), 4U);
}

TEST(ModelChoice, names_a_projector_without_a_pose) {
  Given g = given(RoomKind::kCylinder, 3);
  g.projectors[1].position.reset();
  const auto choice = choose_model(g.projectors, g.samples, g.distance_m);
  ASSERT_FALSE(choice);
  EXPECT_NE(choice.error().message().find("'projector 2'"), std::string::npos);
}

}  // namespace
}  // namespace cyclorama::solve
