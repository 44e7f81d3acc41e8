// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibrator/solve/surface_fit.h"

#include <ceres/ceres.h>
#include <ceres/normal_prior.h>
#include <ceres/rotation.h>
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "appliance/calibrator/solve/uncertainty.h"

namespace cyclorama {
namespace {

constexpr double kLoss_sigmas = 3.0;
constexpr double kBendSigma = 0.05;  // Per knot: a right-angled corner bends by three of it, noise by a hundredth.
constexpr double kMissed_px = 100.0;

struct Moved {
  std::array<double, 3> turn{};
  std::array<double, 3> place{};
  std::array<double, MeasuredLens::kParameters> lens{};
};

Eigen::Matrix3d turned(const Eigen::Matrix3d& R, const std::array<double, 3>& turn) {
  Eigen::Matrix3d by;
  ceres::AngleAxisToRotationMatrix(turn.data(), by.data());  // Column-major, as Eigen's.
  return R * by;
}

class SurfaceProblem {
 public:
  SurfaceProblem(const std::vector<MeasuredProjector>& projectors, std::span<const SurfaceSample> samples,
                 const SurfaceFit& start, const SurfaceFitOptions& options)
      : projectors_(projectors), start_(start), options_(options), surface_(start.surface) {
    ceres::Problem::Options owned;
    owned.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    problem_ = std::make_unique<ceres::Problem>(owned);
    moved_.resize(projectors.size());
    for (std::size_t p = 0; p < projectors.size(); ++p) {
      const auto& from = start.projectors[p];
      const Eigen::Vector3d at = from.T_eye_projector.translation();
      moved_[p].place = {at.x(), at.y(), at.z()};
      moved_[p].lens = from.lens.values;
      for (const int term : held_parameters(options.lens)) moved_[p].lens[static_cast<std::size_t>(term)] = 0.0;
    }
    for (const SurfaceSample& sample : samples) {
      Moved& m = moved_[sample.projector];
      measured_.push_back(problem_->AddResidualBlock(
          make_surface_cost(surface_, sample,
                            start.projectors[sample.projector].T_eye_projector.rotation().toRotationMatrix())
              .release(),
          &loss_, surface_.parameters.data(), m.turn.data(), m.place.data(), m.lens.data()));
    }
    if (surface_.rung == SurfaceRung::kProfile || surface_.rung == SurfaceRung::kMesh) {
      problem_->AddResidualBlock(make_spline_prior(surface_, kBendSigma).release(), nullptr,
                                 surface_.parameters.data());
    }
    for (std::size_t p = 0; p < projectors.size(); ++p) add_priors(p);
  }

  Result<SurfaceFit> solve() {
    ceres::Solver::Options solver;
    solver.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
    solver.max_num_iterations = options_.most_steps;
    solver.function_tolerance = 1e-7;
    solver.logging_type = ceres::SILENT;
    solver.num_threads = 1;
    ceres::Solver::Summary summary;
    ceres::Solve(solver, problem_.get(), &summary);
    if (summary.IsSolutionUsable()) {
      loss_.Reset(new ceres::CauchyLoss(kLoss_sigmas), ceres::TAKE_OWNERSHIP);
      ceres::Solve(solver, problem_.get(), &summary);
    }
    if (!summary.IsSolutionUsable() || !std::isfinite(summary.final_cost)) {
      return Error(
          ErrorCode::kBadData,
          fmt::format("no {} fits from this start; give the projectors' places more exactly", name_of(surface_.rung)));
    }
    SurfaceFit fit;
    fit.surface = surface_;
    fit.cost = summary.final_cost;
    for (std::size_t p = 0; p < moved_.size(); ++p) {
      const auto& from = start_.projectors[p];
      FittedProjector projector;
      projector.lens = from.lens;
      projector.lens.values = moved_[p].lens;
      const auto& at = moved_[p].place;
      projector.T_eye_projector = {
          Eigen::Quaterniond(turned(from.T_eye_projector.rotation().toRotationMatrix(), moved_[p].turn)),
          Eigen::Vector3d(at[0], at[1], at[2])};
      fit.projectors.push_back(projector);
    }
    if (options_.with_covariance) add_covariance(&fit);
    return fit;
  }

 private:
  void add_prior(double* block, const Eigen::VectorXd& mean, const Eigen::VectorXd& sigmas) {
    const Eigen::MatrixXd weights = sigmas.cwiseMax(1e-9).cwiseInverse().asDiagonal();
    problem_->AddResidualBlock(new ceres::NormalPrior(weights, mean), nullptr, block);
  }

  /// Towards the installation's places, from wherever the search begins.
  void add_priors(std::size_t p) {
    const ProjectorPlace& place = *projectors_[p].place;
    Moved& m = moved_[p];
    const Eigen::Matrix3d from = start_.projectors[p].T_eye_projector.rotation().toRotationMatrix();
    const Eigen::AngleAxisd told(
        Eigen::Matrix3d(from.transpose() * place.T_eye_projector.rotation().toRotationMatrix()));
    add_prior(m.turn.data(), told.angle() * told.axis(), Eigen::Vector3d::Constant(place.sigma_rad));
    add_prior(m.place.data(), place.T_eye_projector.translation(), Eigen::Vector3d::Constant(place.sigma_m));
    Eigen::VectorXd sigmas = place.lens.covariance.diagonal().cwiseSqrt();
    add_prior(m.lens.data(), Eigen::Map<const Eigen::VectorXd>(place.lens.values.data(), MeasuredLens::kParameters),
              sigmas);
    problem_->SetManifold(m.lens.data(),
                          new ceres::SubsetManifold(MeasuredLens::kParameters, held_parameters(options_.lens)));
  }

  void add_covariance(SurfaceFit* fit) {
    std::vector<double*> blocks{surface_.parameters.data()};
    std::vector<double> scale;
    const int size = surface_.size();
    for (int i = 0; i < size; ++i) {
      scale.push_back(surface_.rung == SurfaceRung::kProfile || surface_.rung == SurfaceRung::kMesh
                          ? 0.1 / surface_.distance_m
                          : 0.1);
    }
    for (std::size_t p = 0; p < moved_.size(); ++p) {
      blocks.insert(blocks.end(), {moved_[p].turn.data(), moved_[p].place.data(), moved_[p].lens.data()});
      const ProjectorPlace& place = *projectors_[p].place;
      scale.insert(scale.end(), 3, place.sigma_rad);
      scale.insert(scale.end(), 3, place.sigma_m);
      const auto constant = held_parameters(options_.lens);
      for (int i = 0; i < MeasuredLens::kParameters; ++i) {
        if (std::find(constant.begin(), constant.end(), i) != constant.end()) continue;
        scale.push_back(std::max(1e-9, std::sqrt(place.lens.covariance(i, i))));
      }
    }
    const Uncertainty uncertainty =
        uncertainty_of(problem_.get(), blocks, static_cast<int>(scale.size()), 0, scale, measured_);
    fit->rank = uncertainty.rank;
    fit->parameters = static_cast<int>(scale.size());
    for (int i = 0; i < size; ++i) fit->surface_sigmas.push_back(std::sqrt(uncertainty.covariance(i, i)));
    Eigen::Index at = size;
    const auto constant = held_parameters(options_.lens);
    for (FittedProjector& projector : fit->projectors) {
      projector.pose_covariance = uncertainty.covariance.block<6, 6>(at, at);
      projector.lens.covariance.setZero();
      at += 6;
      std::vector<int> free;
      for (int i = 0; i < MeasuredLens::kParameters; ++i) {
        if (std::find(constant.begin(), constant.end(), i) == constant.end()) free.push_back(i);
      }
      for (std::size_t i = 0; i < free.size(); ++i) {
        for (std::size_t j = 0; j < free.size(); ++j) {
          projector.lens.covariance(free[i], free[j]) =
              uncertainty.covariance(at + static_cast<Eigen::Index>(i), at + static_cast<Eigen::Index>(j));
        }
      }
      at += static_cast<Eigen::Index>(free.size());
    }
  }

  const std::vector<MeasuredProjector>& projectors_;
  const SurfaceFit& start_;
  SurfaceFitOptions options_;
  Surface surface_;
  std::vector<Moved> moved_;
  // First one that draws from afar, then one that lets gross errors go.
  ceres::LossFunctionWrapper loss_{new ceres::HuberLoss(kLoss_sigmas), ceres::TAKE_OWNERSHIP};
  std::vector<ceres::ResidualBlockId> measured_;
  std::unique_ptr<ceres::Problem> problem_;
};

}  // namespace

Result<SurfaceFit> fit_surface(const std::vector<MeasuredProjector>& projectors, std::span<const SurfaceSample> samples,
                               const SurfaceFit& start, const SurfaceFitOptions& options) {
  CHECK(start.projectors.size() == projectors.size());
  CHECK(static_cast<int>(start.surface.parameters.size()) == start.surface.size());
  return SurfaceProblem(projectors, samples, start, options).solve();
}

Result<SurfaceFit> surface_start(const std::vector<MeasuredProjector>& projectors,
                                 std::span<const SurfaceSample> samples, double wall_distance_m) {
  SurfaceFit start;
  std::vector<std::size_t> seen(projectors.size(), 0);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const SurfaceSample& sample : samples) {
    CHECK(sample.projector < projectors.size());
    ++seen[sample.projector];
    sum += sample.direction;
  }
  for (std::size_t p = 0; p < projectors.size(); ++p) {
    constexpr std::size_t kLeast = 30;
    if (!projectors[p].place) {
      return Error(ErrorCode::kInvalidArgument,
                   fmt::format("projector '{}' has no place in the installation, and a wall is found by them; measure "
                               "about where it stands",
                               projectors[p].name));
    }
    if (seen[p] < kLeast) {
      return Error(ErrorCode::kInvalidArgument,
                   fmt::format("projector '{}' was seen at {} places, {} are needed; look whether it shines",
                               projectors[p].name, seen[p], kLeast));
    }
    FittedProjector projector;
    projector.lens = projectors[p].place->lens;
    projector.T_eye_projector = projectors[p].place->T_eye_projector;
    start.projectors.push_back(projector);
  }
  Surface& surface = start.surface;
  surface.distance_m = wall_distance_m;
  Eigen::Vector3d back = Eigen::Vector3d::UnitZ();
  if (sum.norm() > 1e-6 * static_cast<double>(samples.size())) back = -sum.normalized();
  Eigen::Vector3d right = Eigen::Vector3d::UnitY().cross(back);
  if (!(right.norm() > 1e-3)) right = Eigen::Vector3d::UnitX();  // Straight up or down: any will do.
  right.normalize();
  surface.R_eye_wall << right, back.cross(right), back;
  surface.rung = SurfaceRung::kPlane;
  surface.parameters = {0.0, 0.0};
  return start;
}

double prediction_error_px(const SurfaceFit& fit, std::span<const SurfaceSample> samples) {
  std::vector<double> squares;
  for (const SurfaceSample& sample : samples) {
    const FittedProjector& projector = fit.projectors[sample.projector];
    const auto nearness = fit.surface.nearness_at(sample.direction);
    const Eigen::Vector3d point = projector.T_eye_projector.rotation().conjugate() *
                                  (sample.direction - nearness.value_or(0.0) * projector.T_eye_projector.translation());
    double square = kMissed_px * kMissed_px;
    if (nearness && point.z() > 1e-4) {
      Eigen::Vector2d pixel;
      project_through_lens(projector.lens.values.data(), point.data(), pixel.data());
      square = std::min(square, 0.5 * (pixel - sample.projector_px).squaredNorm());
    }
    squares.push_back(square);
  }
  if (squares.empty()) return 0.0;
  std::sort(squares.begin(), squares.end());
  squares.resize(squares.size() - squares.size() / 20);
  double sum = 0.0;
  for (const double s : squares) sum += s;
  return std::sqrt(sum / static_cast<double>(squares.size()));
}

}  // namespace cyclorama
