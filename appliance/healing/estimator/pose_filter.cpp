// SPDX-License-Identifier: Apache-2.0
#include "appliance/healing/estimator/pose_filter.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace cyclorama::healing {
namespace {

/// One of a measurement's uncorrelated directions.
struct Direction {
  calibration::PoseStep along;
  double value;
  double variance;
};

/// Calls `use` for each measured direction. Turns and shifts are balanced first: their units differ by orders of
/// magnitude, and eigenvectors are only as precise as the largest eigenvalue allows.
template <typename Use>
void for_directions(const PoseFilter::Measured& measured, const calibration::PoseMatrix& root, const Use& use) {
  calibration::PoseStep unit;
  for (int i = 0; i < 6; ++i) unit[i] = std::max(root.row(i).norm(), 1e-150);
  const calibration::PoseMatrix scaled = unit.asDiagonal() * measured.information * unit.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<calibration::PoseMatrix> parts(0.5 * (scaled + scaled.transpose()));
  const double min = 1e-14 * std::max(parts.eigenvalues().maxCoeff(), 0.0);
  for (int i = 0; i < 6; ++i) {
    const double information = parts.eigenvalues()[i];
    if (!(information > min) || !(information > 1e-290) || !std::isfinite(information)) continue;
    // For an eigenvector e, in balanced units, the measured value of a step x is e^T (x / unit) = along^T x.
    const calibration::PoseStep along = parts.eigenvectors().col(i).cwiseQuotient(unit);
    use(Direction{along, along.dot(measured.step), 1.0 / information});
  }
}

}  // namespace

PoseFilter::PoseFilter(double turn_rad, double shift_m, const Walk& walk) {
  calibration::PoseStep sigma;
  sigma << Eigen::Vector3d::Constant(turn_rad), Eigen::Vector3d::Constant(shift_m);
  root_ = sigma.asDiagonal();
  walk_ << Eigen::Vector3d::Constant(walk.turn_rad), Eigen::Vector3d::Constant(walk.shift_m);
}

void PoseFilter::predict(double seconds) {
  if (!(seconds > 0.0)) return;
  Eigen::Matrix<double, 12, 6> both;
  both.topRows<6>() = root_.transpose();
  both.bottomRows<6>() = calibration::PoseMatrix((std::sqrt(seconds) * walk_).asDiagonal());
  const Eigen::HouseholderQR<Eigen::Matrix<double, 12, 6>> qr(both);
  root_ = calibration::PoseMatrix(qr.matrixQR().topRows<6>().triangularView<Eigen::Upper>()).transpose();
}

PoseFilter::Innovation PoseFilter::innovation(const Measured& measured) const {
  calibration::PoseMatrix root = root_;
  calibration::PoseStep mean = calibration::PoseStep::Zero();
  Innovation sum;
  for_directions(measured, root_, [&](const Direction& d) {
    const calibration::PoseStep phi = root.transpose() * d.along;
    const double variance = phi.squaredNorm() + d.variance;
    const double off = d.value - d.along.dot(mean);
    sum.squared += off * off / variance;
    ++sum.directions;
    const calibration::PoseStep gain = root * phi / variance;
    mean += gain * off;
    root -= gain * phi.transpose() / (1.0 + std::sqrt(d.variance / variance));
  });
  return sum;
}

calibration::PoseStep PoseFilter::update(const Measured& measured) {
  calibration::PoseStep mean = calibration::PoseStep::Zero();
  const calibration::PoseMatrix before = root_;
  for_directions(measured, before, [&](const Direction& d) {
    const calibration::PoseStep phi = root_.transpose() * d.along;
    const double variance = phi.squaredNorm() + d.variance;
    const calibration::PoseStep gain = root_ * phi / variance;
    mean += gain * (d.value - d.along.dot(mean));
    root_ -= gain * phi.transpose() / (1.0 + std::sqrt(d.variance / variance));
  });
  return mean;
}

double PoseFilter::squared_deviations(const calibration::PoseStep& step) const {
  const double squared = root_.partialPivLu().solve(step).squaredNorm();
  return std::isfinite(squared) ? squared : 0.0;
}

void PoseFilter::restart(const calibration::PoseMatrix& covariance) {
  const Eigen::SelfAdjointEigenSolver<calibration::PoseMatrix> parts(0.5 * (covariance + covariance.transpose()));
  const double min = 1e-12 * std::max(parts.eigenvalues().maxCoeff(), 1e-300);
  root_ = parts.eigenvectors() * parts.eigenvalues().cwiseMax(min).cwiseSqrt().asDiagonal();
}

double innovation_limit(int directions, double normal) {
  if (directions <= 0) return 0.0;
  const double ninth = 2.0 / (9.0 * directions);
  const double root = 1.0 - ninth + normal * std::sqrt(ninth);
  return directions * root * root * root;
}

void InnovationWindow::add(const PoseFilter::Innovation& innovation) {
  last_.push_front(innovation);
  if (last_.size() > kMaxCount) last_.pop_back();
}

bool InnovationWindow::is_surprising() const {
  PoseFilter::Innovation sum;
  for (std::size_t i = 0; i < last_.size(); ++i) {
    sum.squared += last_[i].squared;
    sum.directions += last_[i].directions;
    if (i > 0 && sum.squared > innovation_limit(sum.directions)) return true;
  }
  return false;
}

PoseFilter::Measured without_prior(const calibration::PoseStep& step, const calibration::PoseMatrix& information,
                                   const calibration::PoseMatrix& prior) {
  // Solves (information + prior) * step = information * measured for `measured`.
  const Eigen::SelfAdjointEigenSolver<calibration::PoseMatrix> parts(information);
  const calibration::PoseStep told = parts.eigenvectors().transpose() * ((information + prior) * step);
  const double min = 1e-12 * std::max(parts.eigenvalues().maxCoeff(), 0.0);
  calibration::PoseStep measured = calibration::PoseStep::Zero();
  calibration::PoseStep kept = calibration::PoseStep::Zero();
  for (int i = 0; i < 6; ++i) {
    if (!(parts.eigenvalues()[i] > min) || !(parts.eigenvalues()[i] > 1e-290)) continue;
    measured += parts.eigenvectors().col(i) * (told[i] / parts.eigenvalues()[i]);
    kept[i] = parts.eigenvalues()[i];
  }
  return {measured, parts.eigenvectors() * kept.asDiagonal() * parts.eigenvectors().transpose()};
}

}  // namespace cyclorama::healing
