// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibration/surface.h"

// Included before Ceres' headers, whose glog defines a CHECK of its own.
#include "appliance/solve/surface_cost.h"

#include <ceres/gradient_checker.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace cyclorama::solve {
namespace {

std::vector<Eigen::Vector3d> spread() {
  std::vector<Eigen::Vector3d> directions;
  for (double a = -1.0; a <= 1.01; a += 0.1) {
    for (double t = -0.4; t <= 0.41; t += 0.1)
      directions.push_back(Eigen::Vector3d(std::sin(a), t, -std::cos(a)).normalized());
  }
  return directions;
}

calibration::Surface plane() {
  calibration::Surface surface;
  surface.parameters = {0.1, -0.05};
  return surface;
}

calibration::Surface cylinder(double curvature) {
  calibration::Surface surface;
  surface.model = calibration::SurfaceModel::kCylinder;
  surface.parameters = {0.0, 0.0, 0.0, curvature};
  return surface;
}

TEST(Surface, a_cylinder_about_the_eye_has_a_constant_distance) {
  const calibration::Surface surface = cylinder(0.25);
  for (double a = -3.1; a < 3.1; a += 0.2) {
    const auto inverse_depth = surface.inverse_depth_at({std::sin(a), 0.0, -std::cos(a)});
    ASSERT_TRUE(inverse_depth);
    EXPECT_NEAR(1.0 / *inverse_depth, 4.0, 1e-9);
  }
}

TEST(Surface, a_cylinder_becomes_a_plane_continuously) {
  const calibration::Surface flat = plane();
  for (const double curvature : {0.0, 1e-12, -1e-12, 1e-9}) {
    calibration::Surface nearly = cylinder(curvature);
    nearly.parameters[0] = 0.1;
    nearly.parameters[1] = -0.05;
    for (const Eigen::Vector3d& d : spread()) {
      const auto a = flat.inverse_depth_at(d);
      const auto b = nearly.inverse_depth_at(d);
      ASSERT_TRUE(a && b);
      EXPECT_NEAR(*a, *b, 1e-7);
    }
  }
}

TEST(Surface, each_larger_model_starts_equal_to_the_smaller_one) {
  for (const calibration::Surface& from : {plane(), cylinder(0.25), cylinder(0.1)}) {
    for (const calibration::SurfaceModel model : calibration::kSurfaceModels) {
      if (model == calibration::SurfaceModel::kPlane ||
          (model == calibration::SurfaceModel::kCylinder && from.model != calibration::SurfaceModel::kPlane))
        continue;
      const calibration::Surface richer = calibration::Surface::start(model, from, spread(), 0.06);
      ASSERT_EQ(static_cast<int>(richer.parameters.size()), richer.size());
      for (const Eigen::Vector3d& d : spread()) {
        const auto a = from.inverse_depth_at(d);
        const auto b = richer.inverse_depth_at(d);
        ASSERT_TRUE(a && b);
        // A profile's start has no tilt, and a spline's coefficients differ from its values; an approximation suffices
        // for a start.
        const double tolerance =
            model == calibration::SurfaceModel::kQuadric || model == calibration::SurfaceModel::kCylinder ? 1e-9 : 0.02;
        EXPECT_NEAR(*a, *b, tolerance) << calibration::name_of(model);
      }
    }
  }
}

TEST(Surface, is_missed_by_rays_past_a_bulging_wall) {
  EXPECT_TRUE(cylinder(-1.0).inverse_depth_at(Eigen::Vector3d(0.0, 0.0, -1.0)));
  EXPECT_FALSE(cylinder(-1.0).inverse_depth_at(Eigen::Vector3d(0.5, 0.0, -0.866)));
}

/// The residuals of one sample in the form that Ceres' gradient checker needs. Blocks: the surface's parameters, the
/// projector's.
class SampleCost : public ceres::CostFunction {
 public:
  SampleCost(const calibration::Surface& shape, const MapSample& sample) : shape_(shape), sample_(sample) {
    set_num_residuals(2);
    *mutable_parameter_block_sizes() = {shape.size(), LitProjector::kNumbers};
  }
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    Eigen::Matrix3d axes;
    axes << 1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0;
    calibration::InverseDepthSlopes wall;
    LitProjector::Slopes slopes;
    Eigen::Vector2d errors;
    const auto inverse_depth = shape_.inverse_depth_at(blocks[0], sample_.direction, &wall);
    if (!inverse_depth || !LitProjector(axes, blocks[1]).residuals(sample_, *inverse_depth, &errors, &slopes))
      return false;
    for (int r = 0; r < 2; ++r) {
      residuals[r] = errors[r];
      if (jacobians == nullptr) continue;
      if (jacobians[0] != nullptr) {
        std::fill_n(jacobians[0] + r * shape_.size(), shape_.size(), 0.0);
        for (std::size_t i = 0; i < static_cast<std::size_t>(wall.count); ++i) {
          jacobians[0][r * shape_.size() + wall.parameters[i]] += slopes.by_inverse_depth[r] * wall.slopes[i];
        }
      }
      for (int i = 0; jacobians[1] != nullptr && i < LitProjector::kNumbers; ++i) {
        jacobians[1][r * LitProjector::kNumbers + i] = slopes.by_numbers(r, i);
      }
    }
    return true;
  }

 private:
  const calibration::Surface& shape_;
  MapSample sample_;
};

calibration::Surface disturbed(calibration::SurfaceModel model) {
  const calibration::Surface from = model == calibration::SurfaceModel::kPlane ? plane() : cylinder(0.2);
  calibration::Surface surface =
      model == calibration::SurfaceModel::kPlane ? from : calibration::Surface::start(model, from, spread(), 0.3);
  for (std::size_t i = 0; i < surface.parameters.size(); ++i) {
    surface.parameters[i] += 0.003 * std::sin(3.0 * static_cast<double>(i) + 1.0);
  }
  return surface;
}

TEST(SurfaceCost, has_the_jacobian_of_differences_for_every_model) {
  for (const calibration::SurfaceModel model : calibration::kSurfaceModels) {
    const calibration::Surface surface = disturbed(model);
    MapSample sample;
    sample.projector_px = {900.0, 500.0};
    sample.direction = Eigen::Vector3d(0.31, 0.12, -0.9).normalized();
    const SampleCost cost(surface, sample);
    const double turned[] = {0.02, -0.03, 0.05, 0.4, 1.1, 0.3, 1500.0, 960.0, 540.0, -0.02, 0.01, 3e-3, 1e-3, 2e-3};
    const double straight[] = {0.0, 0.0, 0.0, 0.4, 1.1, 0.3, 1500.0, 960.0, 540.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    ceres::NumericDiffOptions steps;
    steps.ridders_relative_initial_step_size = 1e-3;  // Curvatures are small.
    const ceres::GradientChecker checker(&cost, static_cast<const std::vector<const ceres::Manifold*>*>(nullptr),
                                         steps);
    for (const double* numbers : {turned, straight}) {
      const double* blocks[] = {surface.parameters.data(), numbers};
      ceres::GradientChecker::ProbeResults results;
      EXPECT_TRUE(checker.Probe(blocks, 1e-5, &results)) << calibration::name_of(model) << results.error_log;
    }
  }
}

TEST(SplinePrior, has_the_derivatives_of_differences) {
  for (const calibration::SurfaceModel model :
       {calibration::SurfaceModel::kProfile, calibration::SurfaceModel::kMesh}) {
    const calibration::Surface surface = disturbed(model);
    const SplinePrior prior(surface, 0.05);
    const auto slopes_at = [&](const std::vector<double>& at) {
      Eigen::VectorXd gradient = Eigen::VectorXd::Zero(surface.size());
      Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(surface.size(), surface.size());
      EXPECT_TRUE(prior.add(surface, at.data(), &gradient, &normal));
      return std::pair(gradient, normal);
    };
    const auto [gradient, normal] = slopes_at(surface.parameters);
    EXPECT_TRUE(normal.isLowerTriangular());
    for (int i = 0; i < surface.size(); ++i) {
      constexpr double kStep = 1e-6;
      std::vector<double> above = surface.parameters;
      std::vector<double> below = surface.parameters;
      above[static_cast<std::size_t>(i)] += kStep;
      below[static_cast<std::size_t>(i)] -= kStep;
      const auto high = prior.add(surface, above.data(), nullptr, nullptr);
      const auto low = prior.add(surface, below.data(), nullptr, nullptr);
      ASSERT_TRUE(high && low);
      const double scale = gradient.norm();
      EXPECT_NEAR((*high - *low) / (2.0 * kStep), gradient[i], 1e-6 * scale) << calibration::name_of(model) << " " << i;
      const Eigen::VectorXd column = (slopes_at(above).first - slopes_at(below).first) / (2.0 * kStep);
      const Eigen::MatrixXd whole = normal.selfadjointView<Eigen::Lower>();
      // The scale's own curvature is that of the squares alone, without the wall's second derivatives.
      EXPECT_LE((column - whole.col(i)).norm(), 1e-3 * whole.norm()) << calibration::name_of(model) << " " << i;
    }
  }
}

TEST(Surface, models_are_read_by_their_names) {
  for (const calibration::SurfaceModel model : calibration::kSurfaceModels)
    EXPECT_EQ(calibration::surface_model(calibration::name_of(model)), model);
  EXPECT_FALSE(calibration::surface_model("sphere"));
}

}  // namespace
}  // namespace cyclorama::solve
