// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibrator/solve/surface.h"

#include <ceres/gradient_checker.h>
#include <gtest/gtest.h>

#include <cmath>

#include "appliance/calibrator/solve/surface_cost.h"

namespace cyclorama {
namespace {

std::vector<Eigen::Vector3d> spread() {
  std::vector<Eigen::Vector3d> directions;
  for (double a = -1.0; a <= 1.01; a += 0.1) {
    for (double t = -0.4; t <= 0.41; t += 0.1)
      directions.push_back(Eigen::Vector3d(std::sin(a), t, -std::cos(a)).normalized());
  }
  return directions;
}

Surface plane() {
  Surface surface;
  surface.parameters = {0.1, -0.05};
  return surface;
}

Surface cylinder(double curvature) {
  Surface surface;
  surface.rung = SurfaceRung::kCylinder;
  surface.parameters = {0.0, 0.0, 0.0, curvature};
  return surface;
}

TEST(Surface, a_cylinder_about_the_eye_is_equally_far_all_round) {
  const Surface surface = cylinder(0.25);
  for (double a = -3.1; a < 3.1; a += 0.2) {
    const auto nearness = surface.nearness_at({std::sin(a), 0.0, -std::cos(a)});
    ASSERT_TRUE(nearness);
    EXPECT_NEAR(1.0 / *nearness, 4.0, 1e-9);
  }
}

TEST(Surface, a_cylinder_goes_over_into_a_plane_without_a_jump) {
  const Surface flat = plane();
  for (const double curvature : {0.0, 1e-12, -1e-12, 1e-9}) {
    Surface nearly = cylinder(curvature);
    nearly.parameters[0] = 0.1;
    nearly.parameters[1] = -0.05;
    for (const Eigen::Vector3d& d : spread()) {
      const auto a = flat.nearness_at(d);
      const auto b = nearly.nearness_at(d);
      ASSERT_TRUE(a && b);
      EXPECT_NEAR(*a, *b, 1e-7);
    }
  }
}

TEST(Surface, each_richer_start_says_what_the_lesser_said) {
  for (const Surface& from : {plane(), cylinder(0.25), cylinder(0.1)}) {
    for (const SurfaceRung rung : kSurfaceRungs) {
      if (rung == SurfaceRung::kPlane || (rung == SurfaceRung::kCylinder && from.rung != SurfaceRung::kPlane)) continue;
      const Surface richer = Surface::start(rung, from, spread(), 0.06);
      ASSERT_EQ(static_cast<int>(richer.parameters.size()), richer.size());
      for (const Eigen::Vector3d& d : spread()) {
        const auto a = from.nearness_at(d);
        const auto b = richer.nearness_at(d);
        ASSERT_TRUE(a && b);
        // A profile's start has no tilt and a spline's coefficients are no values: near is enough to begin with.
        const double tolerance = rung == SurfaceRung::kQuadric || rung == SurfaceRung::kCylinder ? 1e-9 : 0.02;
        EXPECT_NEAR(*a, *b, tolerance) << name_of(rung);
      }
    }
  }
}

TEST(Surface, is_missed_by_what_looks_past_a_wall_that_bulges) {
  EXPECT_TRUE(cylinder(-1.0).nearness_at(Eigen::Vector3d(0.0, 0.0, -1.0)));
  EXPECT_FALSE(cylinder(-1.0).nearness_at(Eigen::Vector3d(0.5, 0.0, -0.866)));
}

TEST(SurfaceCost, has_the_jacobian_that_differences_give_on_every_rung) {
  for (const SurfaceRung rung : kSurfaceRungs) {
    const Surface from = rung == SurfaceRung::kPlane ? plane() : cylinder(0.2);
    Surface surface = rung == SurfaceRung::kPlane ? from : Surface::start(rung, from, spread(), 0.3);
    for (std::size_t i = 0; i < surface.parameters.size(); ++i)
      surface.parameters[i] += 0.003 * std::sin(3.0 * static_cast<double>(i) + 1.0);
    SurfaceSample sample;
    sample.projector_px = {900.0, 500.0};
    sample.direction = Eigen::Vector3d(0.31, 0.12, -0.9).normalized();
    Eigen::Matrix3d axes;
    axes << 1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0;
    const auto cost = make_surface_cost(surface, sample, axes);
    const double turn[] = {0.02, -0.03, 0.05};
    const double place[] = {0.4, 1.1, 0.3};
    const double lens[] = {1500.0, 960.0, 540.0, -0.02, 0.01, 0.0, 1e-3, 1e-3};
    const double* blocks[] = {surface.parameters.data(), turn, place, lens};
    ceres::NumericDiffOptions steps;
    steps.ridders_relative_initial_step_size = 1e-3;  // Of curvatures, which are small.
    const ceres::GradientChecker checker(cost.get(), static_cast<const std::vector<const ceres::Manifold*>*>(nullptr),
                                         steps);
    ceres::GradientChecker::ProbeResults results;
    EXPECT_TRUE(checker.Probe(blocks, 1e-5, &results)) << name_of(rung) << results.error_log;
    if (rung != SurfaceRung::kProfile && rung != SurfaceRung::kMesh) continue;
    const auto prior = make_spline_prior(surface, 0.05);
    const ceres::GradientChecker prior_checker(prior.get(),
                                               static_cast<const std::vector<const ceres::Manifold*>*>(nullptr), steps);
    EXPECT_TRUE(prior_checker.Probe(blocks, 1e-5, &results)) << name_of(rung) << results.error_log;
  }
}

TEST(Surface, rungs_are_read_by_their_names) {
  for (const SurfaceRung rung : kSurfaceRungs) EXPECT_EQ(surface_rung(name_of(rung)), rung);
  EXPECT_FALSE(surface_rung("sphere"));
}

}  // namespace
}  // namespace cyclorama
