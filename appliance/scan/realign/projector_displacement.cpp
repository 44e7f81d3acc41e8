// SPDX-License-Identifier: Apache-2.0
#include "appliance/scan/realign/projector_displacement.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

namespace cyclorama::scan {
namespace {

constexpr std::size_t kMinSamples = 24;
constexpr std::size_t kMaxSamples = 2500;
constexpr int kMaxRounds = 40;
constexpr double kRobust_sigmas = 3.0;
constexpr double kFloor_px = 0.1;  // Sigma of a sample: residual errors of the wall and lens models.
// Maximum residual of an explanation, at a width of 1920 pixels. The wall and lens were fitted where the projector's
// light fell before, and are slightly less accurate beside it.
constexpr double kWorstFit_px = 0.7;
constexpr double kWorseFit = 3.0;
// Limits of a displacement; beyond them the projector was taken down. A turned lens looks much like a projector nearer
// to the wall, so beyond these limits the lens is tried, with kPositionPrior_m as the position's sigma.
constexpr double kMaxMoved_m = 0.3;
constexpr double kMaxTurned_rad = 0.26;
constexpr double kPositionPrior_m = 0.02;

// Parameters: rotation (in the projector's frame), position, relative focal length, and principal point (in picture
// widths).
constexpr int kPose = 6;
constexpr int kWithLens = 9;
constexpr double kNudge = 1e-6;
using Vector9 = Eigen::Matrix<double, kWithLens, 1>;
using Matrix9 = Eigen::Matrix<double, kWithLens, kWithLens>;

struct Sample {
  Eigen::Vector2d pixel;
  Eigen::Vector3d direction;
  double inverse_depth = 0.0;
  double sigma_px = 0.1;
};

calibration::FittedProjector moved_by(const calibration::FittedProjector& from, const Vector9& step) {
  calibration::FittedProjector to = from;
  const Eigen::Vector3d turn = step.head<3>();
  Eigen::Quaterniond rotation = from.T_eye_projector.rotation();
  if (turn.norm() > 0.0) rotation = rotation * Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
  to.T_eye_projector = {rotation, from.T_eye_projector.translation() + step.segment<3>(3)};
  to.lens.values[calibration::MeasuredLens::kFocal] *= 1.0 + step(6);
  to.lens.values[calibration::MeasuredLens::kCentreU] += step(7) * from.lens.width_px;
  to.lens.values[calibration::MeasuredLens::kCentreV] += step(8) * from.lens.width_px;
  return to;
}

std::optional<Eigen::Vector2d> error_px(const calibration::FittedProjector& projector, const Sample& sample) {
  const auto& T = projector.T_eye_projector;
  const Eigen::Vector3d point = T.rotation().conjugate() * (sample.direction - sample.inverse_depth * T.translation());
  if (!(point.z() > 1e-6)) return std::nullopt;
  Eigen::Vector2d pixel;
  calibration::project_through_lens(projector.lens.values.data(), point.data(), pixel.data());
  if (!pixel.allFinite()) return std::nullopt;
  return pixel - sample.pixel;
}

double trimmed_rms(const calibration::FittedProjector& projector, const std::vector<Sample>& samples) {
  std::vector<double> squares;
  for (const Sample& sample : samples) {
    const auto error = error_px(projector, sample);
    squares.push_back(error ? 0.5 * error->squaredNorm() : 1e6);
  }
  std::sort(squares.begin(), squares.end());
  squares.resize(squares.size() - squares.size() / 20);
  double sum = 0.0;
  for (const double square : squares) sum += square;
  return std::sqrt(sum / static_cast<double>(squares.size()));
}

/// Fits the first `free` parameters by Levenberg-Marquardt with Cauchy weights, and the pose's covariance.
/// `position_sigma_m` is the prior sigma of the position; 0 means no prior.
std::optional<calibration::FittedProjector> fitted(const calibration::FittedProjector& from,
                                                   const std::vector<Sample>& samples, int free,
                                                   double position_sigma_m = 0.0) {
  const double hold = position_sigma_m > 0.0 ? 1.0 / (position_sigma_m * position_sigma_m) : 0.0;
  const auto away = [&](const calibration::FittedProjector& projector) -> Eigen::Vector3d {
    return projector.T_eye_projector.translation() - from.T_eye_projector.translation();
  };
  calibration::FittedProjector best = from;
  double damping = 1e-6;
  // The initial residuals may be large, so the weights' scale starts at their size and decreases to that of the noise.
  double scale_px = trimmed_rms(best, samples);
  for (int round = 0; round < kMaxRounds; ++round) {
    Matrix9 normal = Matrix9::Zero();
    Vector9 right = Vector9::Zero();
    double cost = 0.0;
    const auto cost_of = [&](const Eigen::Vector2d& error, double sigma_px) {
      const double limit = kRobust_sigmas * std::max(sigma_px, scale_px);
      return limit * limit * std::log1p(error.squaredNorm() / (limit * limit)) / (sigma_px * sigma_px);
    };
    for (const Sample& sample : samples) {
      const auto error = error_px(best, sample);
      if (!error) continue;
      Eigen::Matrix<double, 2, kWithLens> jacobian = Eigen::Matrix<double, 2, kWithLens>::Zero();
      bool is_whole = true;
      for (int i = 0; i < free; ++i) {
        Vector9 nudge = Vector9::Zero();
        nudge(i) = kNudge;
        const auto beside = error_px(moved_by(best, nudge), sample);
        is_whole = is_whole && beside.has_value();
        if (beside) jacobian.col(i) = (*beside - *error) / kNudge;
      }
      if (!is_whole) continue;
      const double limit = kRobust_sigmas * std::max(sample.sigma_px, scale_px);
      const double weight = 1.0 / (sample.sigma_px * sample.sigma_px * (1.0 + error->squaredNorm() / (limit * limit)));
      normal += weight * jacobian.transpose() * jacobian;
      right -= weight * jacobian.transpose() * *error;
      cost += cost_of(*error, sample.sigma_px);
    }
    for (int i = 3; i < kPose; ++i) {
      normal(i, i) += hold;
      right(i) -= hold * away(best)(i - 3);
    }
    cost += hold * away(best).squaredNorm();
    const auto total = [&](const calibration::FittedProjector& projector) {
      double sum = hold * away(projector).squaredNorm();
      for (const Sample& sample : samples) {
        const auto error = error_px(projector, sample);
        sum += error ? cost_of(*error, sample.sigma_px) : 1e6;
      }
      return sum;
    };
    const Eigen::MatrixXd block = normal.topLeftCorner(free, free);
    bool is_better = false;
    Eigen::VectorXd step;
    for (int attempt = 0; attempt < 8 && !is_better; ++attempt) {
      Eigen::MatrixXd damped = block;
      damped.diagonal() *= 1.0 + damping;
      const Eigen::LDLT<Eigen::MatrixXd> factor(damped);
      if (factor.info() != Eigen::Success || !factor.isPositive()) return std::nullopt;
      step = factor.solve(right.head(free));
      if (!step.allFinite()) return std::nullopt;
      Vector9 whole = Vector9::Zero();
      whole.head(free) = step;
      const calibration::FittedProjector next = moved_by(best, whole);
      is_better = total(next) <= cost * (1.0 + 1e-12);
      if (is_better) best = next;
      damping = is_better ? std::max(1e-9, 0.1 * damping) : 10.0 * damping;
    }
    const Eigen::LDLT<Eigen::MatrixXd> factor(block);
    best.pose_covariance = factor.solve(Eigen::MatrixXd::Identity(free, free)).topLeftCorner<kPose, kPose>();
    const double next_px = trimmed_rms(best, samples);
    const bool is_steady = std::abs(next_px - scale_px) <= 1e-3 * scale_px;
    scale_px = std::min(scale_px, next_px);
    if ((!is_better || step.norm() < 1e-9) && is_steady) break;
  }
  if (!best.pose_covariance.allFinite()) return std::nullopt;
  return best;
}

std::vector<Sample> samples_of(std::span<const solve::MapSample> seen, const InverseDepthAt& inverse_depth) {
  std::vector<Sample> samples;
  std::size_t every = std::max<std::size_t>(1, seen.size() / kMaxSamples);
  if (every > 1 && every % 2 == 0) ++every;  // An odd stride is usually coprime to the length of the lattice's rows.
  for (std::size_t i = 0; i < seen.size(); i += every) {
    const double near = inverse_depth(seen[i].direction);
    if (!(near >= 0.0) || !std::isfinite(near)) continue;
    samples.push_back({seen[i].projector_px, seen[i].direction, near, std::hypot(seen[i].sigma_px, kFloor_px)});
  }
  return samples;
}

/// Returns the previous map's control points as samples.
std::vector<solve::MapSample> places_of(const calibration::MeasuredMap& map) {
  std::vector<solve::MapSample> correspondences;
  constexpr double kSure_px = 0.5;
  for (int y = 0; y <= map.cells_y; ++y) {
    for (int x = 0; x <= map.cells_x; ++x) {
      const auto at =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(map.cells_x + 1) + static_cast<std::size_t>(x);
      if (!map.directions[at].allFinite() || !(map.sigma_px[at] < kSure_px)) continue;
      const Eigen::Vector2d pixel(x * static_cast<double>(map.width_px) / map.cells_x,
                                  y * static_cast<double>(map.height_px) / map.cells_y);
      correspondences.push_back({pixel, map.directions[at], map.sigma_px[at]});
    }
  }
  return correspondences;
}

}  // namespace

std::optional<Displacement> find_displacement(const calibration::FittedProjector& before,
                                              const calibration::MeasuredMap& map,
                                              std::span<const solve::MapSample> seen,
                                              const InverseDepthAt& inverse_depth) {
  const std::vector<solve::MapSample> old_places = places_of(map);
  const std::vector<Sample> then = samples_of(old_places, inverse_depth);
  const std::vector<Sample> now = samples_of(seen, inverse_depth);
  if (then.size() < kMinSamples || now.size() < kMinSamples) return std::nullopt;
  // The old map is fitted by the same procedure, so that systematic errors of the fit cancel in the displacement.
  const auto stood = fitted(before, then, kPose);
  if (!stood) return std::nullopt;
  const auto stands = fitted(*stood, now, kPose);
  if (!stands) return std::nullopt;
  Displacement finding;
  finding.projector = *stands;
  finding.before_px = trimmed_rms(*stood, then);
  finding.after_px = trimmed_rms(*stands, now);
  finding.turned_rad = stood->T_eye_projector.rotation().angularDistance(stands->T_eye_projector.rotation());
  finding.moved_m = (stands->T_eye_projector.translation() - stood->T_eye_projector.translation()).norm();
  const double worst_px = kWorseFit * finding.before_px + kWorstFit_px * map.width_px / 1920.0;
  const bool is_explained = finding.after_px <= worst_px;
  if (is_explained && finding.moved_m <= kMaxMoved_m && finding.turned_rad <= kMaxTurned_rad) {
    finding.verdict = DisplacementVerdict::kDisplaced;
    return finding;
  }
  const auto turned = fitted(*stood, now, kWithLens, kPositionPrior_m);
  if (!turned) return finding;
  finding.with_lens_px = trimmed_rms(*turned, now);
  finding.zoom =
      turned->lens.values[calibration::MeasuredLens::kFocal] / stood->lens.values[calibration::MeasuredLens::kFocal];
  finding.shift_px = {turned->lens.values[calibration::MeasuredLens::kCentreU] -
                          stood->lens.values[calibration::MeasuredLens::kCentreU],
                      turned->lens.values[calibration::MeasuredLens::kCentreV] -
                          stood->lens.values[calibration::MeasuredLens::kCentreV]};
  if (finding.with_lens_px <= worst_px) finding.verdict = DisplacementVerdict::kLensTurned;
  return finding;
}

std::optional<Eigen::Vector3d> drawn_direction(const calibration::FittedProjector& projector,
                                               const calibration::BrownLens& lens, const Eigen::Vector2d& pixel,
                                               const InverseDepthAt& inverse_depth) {
  const auto ray = calibration::direction_through(lens, pixel);
  if (!ray) return std::nullopt;
  return wall_direction_from(projector.T_eye_projector.translation(), projector.T_eye_projector.rotation() * *ray,
                             inverse_depth);
}

}  // namespace cyclorama::scan
