// SPDX-License-Identifier: Apache-2.0
#include "appliance/solve/surface_problem.h"

#include <algorithm>
#include <cmath>

namespace cyclorama::solve {
namespace {

constexpr double kLoss_sigmas = 3.0;
// Per knot. A right-angled corner bends by three sigmas, noise by a hundredth of a sigma.
constexpr double kBendSigma = 0.05;
constexpr double kMinSigma = 1e-9;

}  // namespace

SurfaceProblem::SurfaceProblem(const std::vector<MeasuredProjector>& projectors, std::span<const MapSample> samples,
                               const calibration::SurfaceFit& start, calibration::LensModel lens)
    : projectors_(projectors), samples_(samples), start_(start), surface_(start.surface) {
  const std::vector<int> held = calibration::held_parameters(lens);
  for (int i = 0; i < calibration::MeasuredLens::kParameters; ++i) {
    if (std::find(held.begin(), held.end(), i) == held.end()) free_of_lens_.push_back(i);
  }
  if (surface_.model == calibration::SurfaceModel::kProfile || surface_.model == calibration::SurfaceModel::kMesh) {
    spline_prior_.emplace(surface_, kBendSigma);
  }
  const Eigen::Index total = first_of(projectors.size());
  numbers_ = Eigen::VectorXd::Zero(total);
  prior_means_ = Eigen::VectorXd::Zero(total - first_of(0));
  prior_sigmas_ = Eigen::VectorXd::Ones(total - first_of(0));
  numbers_.head(first_of(0)) = Eigen::Map<const Eigen::VectorXd>(surface_.parameters.data(), first_of(0));
  for (std::size_t p = 0; p < projectors.size(); ++p) {
    const calibration::FittedProjector& from = start.projectors[p];
    const ProjectorPosePrior& position = *projectors[p].position;
    axes_.push_back(from.T_eye_projector.rotation().toRotationMatrix());
    const Eigen::Index first = first_of(p);
    const Eigen::Index prior = first - first_of(0);
    numbers_.segment<3>(first + 3) = from.T_eye_projector.translation();
    // The prior mean is the installation's pose, wherever the search starts.
    const Eigen::AngleAxisd told(
        Eigen::Matrix3d(axes_[p].transpose() * position.T_eye_projector.rotation().toRotationMatrix()));
    prior_means_.segment<3>(prior) = told.angle() * told.axis();
    prior_means_.segment<3>(prior + 3) = position.T_eye_projector.translation();
    prior_sigmas_.segment<3>(prior).setConstant(std::max(kMinSigma, position.sigma_rad));
    prior_sigmas_.segment<3>(prior + 3).setConstant(std::max(kMinSigma, position.sigma_m));
    for (std::size_t i = 0; i < free_of_lens_.size(); ++i) {
      const auto number = static_cast<std::size_t>(free_of_lens_[i]);
      const auto at = static_cast<Eigen::Index>(6 + i);
      numbers_[first + at] = from.lens.values[number];
      prior_means_[prior + at] = position.lens.values[number];
      prior_sigmas_[prior + at] =
          std::max(kMinSigma, std::sqrt(position.lens.covariance(free_of_lens_[i], free_of_lens_[i])));
    }
  }
}

Eigen::Index SurfaceProblem::first_of(std::size_t projector) const {
  return surface_.size() + static_cast<Eigen::Index>(projector * (6 + free_of_lens_.size()));
}

std::array<double, LitProjector::kNumbers> SurfaceProblem::numbers_of(const Eigen::VectorXd& at,
                                                                      std::size_t projector) const {
  std::array<double, LitProjector::kNumbers> numbers{};  // Parameters that are not free are 0.
  const Eigen::Index first = first_of(projector);
  for (int i = 0; i < 6; ++i) numbers[static_cast<std::size_t>(i)] = at[first + i];
  for (std::size_t i = 0; i < free_of_lens_.size(); ++i) {
    numbers[6 + static_cast<std::size_t>(free_of_lens_[i])] = at[first + 6 + static_cast<Eigen::Index>(i)];
  }
  return numbers;
}

std::optional<double> SurfaceProblem::add_samples(const Eigen::VectorXd& at, Eigen::VectorXd* ret_gradient,
                                                  Eigen::MatrixXd* ret_normal) const {
  std::vector<LitProjector> lit;
  for (std::size_t p = 0; p < projectors_.size(); ++p) lit.emplace_back(axes_[p], numbers_of(at, p).data());
  const bool wants_slopes = ret_gradient != nullptr;
  const auto own = static_cast<Eigen::Index>(6 + free_of_lens_.size());
  double cost = 0.0;
  calibration::InverseDepthSlopes wall;
  LitProjector::Slopes slopes;
  Eigen::Matrix<double, 2, Eigen::Dynamic, 0, 2, LitProjector::kNumbers> free(2, own);
  for (const MapSample& sample : samples_) {
    const auto inverse_depth = surface_.inverse_depth_at(at.data(), sample.direction, wants_slopes ? &wall : nullptr);
    Eigen::Vector2d error;
    if (!inverse_depth ||
        !lit[sample.projector].residuals(sample, *inverse_depth, &error, wants_slopes ? &slopes : nullptr)) {
      return std::nullopt;
    }
    const WeighedSquare share = weighed(loss_, kLoss_sigmas, error.squaredNorm());
    cost += share.cost;
    if (!wants_slopes) continue;
    const Eigen::Index first = first_of(sample.projector);
    free.leftCols<6>() = slopes.by_numbers.leftCols<6>();
    for (std::size_t i = 0; i < free_of_lens_.size(); ++i) {
      free.col(static_cast<Eigen::Index>(6 + i)) = slopes.by_numbers.col(6 + free_of_lens_[i]);
    }
    // The wall's part of the Jacobian has rank one: it is the derivative by the inverse depth times the derivatives of
    // the inverse depth.
    const Eigen::Vector2d by_inverse_depth = share.weight * slopes.by_inverse_depth;
    const double curvature = by_inverse_depth.dot(slopes.by_inverse_depth);
    const double slope = by_inverse_depth.dot(error);
    const Eigen::VectorXd mixed = free.transpose() * by_inverse_depth;
    for (std::size_t i = 0; i < static_cast<std::size_t>(wall.count); ++i) {
      const int a = wall.parameters[i];
      (*ret_gradient)[a] += wall.slopes[i] * slope;
      for (std::size_t j = 0; j <= i; ++j) {  // Ascending indices.
        (*ret_normal)(a, wall.parameters[j]) += curvature * wall.slopes[i] * wall.slopes[j];
      }
      ret_normal->col(a).segment(first, own) += wall.slopes[i] * mixed;
    }
    ret_gradient->segment(first, own) += share.weight * (free.transpose() * error);
    for (Eigen::Index i = 0; i < own; ++i) {
      const Eigen::Vector2d column = share.weight * free.col(i);
      ret_normal->col(first + i).segment(first + i, own - i) += free.rightCols(own - i).transpose() * column;
    }
  }
  return cost;
}

std::optional<double> SurfaceProblem::add_priors(const Eigen::VectorXd& at, Eigen::VectorXd* ret_gradient,
                                                 Eigen::MatrixXd* ret_normal) const {
  const Eigen::Index first = first_of(0);
  const Eigen::Index count = at.size() - first;
  const Eigen::VectorXd sigmas = (at.tail(count) - prior_means_).cwiseQuotient(prior_sigmas_);
  if (ret_gradient != nullptr) {
    ret_gradient->tail(count) += sigmas.cwiseQuotient(prior_sigmas_);
    ret_normal->diagonal().tail(count) += prior_sigmas_.cwiseAbs2().cwiseInverse();
  }
  double cost = 0.5 * sigmas.squaredNorm();
  if (spline_prior_) {
    const auto bends = spline_prior_->add(surface_, at.data(), ret_gradient, ret_normal);
    if (!bends) return std::nullopt;
    cost += *bends;
  }
  return cost;
}

std::optional<double> SurfaceProblem::add_all(const Eigen::VectorXd& at, Eigen::VectorXd* ret_gradient,
                                              Eigen::MatrixXd* ret_normal) const {
  const auto samples = add_samples(at, ret_gradient, ret_normal);
  const auto priors = samples ? add_priors(at, ret_gradient, ret_normal) : std::nullopt;
  if (!priors || !std::isfinite(*samples + *priors)) return std::nullopt;
  return *samples + *priors;
}

std::optional<double> SurfaceProblem::linearise() {
  gradient_ = Eigen::VectorXd::Zero(numbers_.size());
  normal_ = Eigen::MatrixXd::Zero(numbers_.size(), numbers_.size());
  return add_all(numbers_, &gradient_, &normal_);
}

std::optional<DampedProblem::Attempt> SurfaceProblem::attempt(double damping) {
  Eigen::VectorXd step;
  if (!damped_solution(normal_, gradient_, damping, &step)) return std::nullopt;
  candidate_ = numbers_ + step;
  const auto cost = add_all(candidate_, nullptr, nullptr);
  if (!cost) return std::nullopt;
  const double predicted = -gradient_.dot(step) - 0.5 * step.dot(normal_.selfadjointView<Eigen::Lower>() * step);
  return Attempt{*cost, predicted, step.norm() / (numbers_.norm() + 1e-8)};
}

Eigen::MatrixXd SurfaceProblem::normal(bool measured_alone) const {
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(numbers_.size());
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(numbers_.size(), numbers_.size());
  add_samples(numbers_, &gradient, &normal);
  if (!measured_alone) add_priors(numbers_, &gradient, &normal);
  return normal;
}

std::vector<double> SurfaceProblem::scales() const {
  const bool is_spline =
      surface_.model == calibration::SurfaceModel::kProfile || surface_.model == calibration::SurfaceModel::kMesh;
  std::vector<double> scales(static_cast<std::size_t>(surface_.size()), is_spline ? 0.1 / surface_.distance_m : 0.1);
  scales.insert(scales.end(), prior_sigmas_.begin(), prior_sigmas_.end());
  return scales;
}

calibration::SurfaceFit SurfaceProblem::found(double cost) const {
  calibration::SurfaceFit fit;
  fit.surface = surface_;
  std::copy_n(numbers_.begin(), surface_.parameters.size(), fit.surface.parameters.begin());
  fit.cost = cost;
  for (std::size_t p = 0; p < projectors_.size(); ++p) {
    const auto numbers = numbers_of(numbers_, p);
    calibration::FittedProjector projector;
    projector.lens = start_.projectors[p].lens;
    std::copy_n(numbers.begin() + 6, projector.lens.values.size(), projector.lens.values.begin());
    const Eigen::Vector3d turn(numbers[0], numbers[1], numbers[2]);
    const double angle = turn.norm();
    Eigen::Matrix3d axes = axes_[p];
    if (angle > 0.0) axes = axes * Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
    projector.T_eye_projector = {Eigen::Quaterniond(axes), Eigen::Vector3d(numbers[3], numbers[4], numbers[5])};
    fit.projectors.push_back(projector);
  }
  return fit;
}

}  // namespace cyclorama::solve
