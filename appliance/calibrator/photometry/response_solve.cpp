// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibrator/photometry/response_solve.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "appliance/calibrator/photometry/cubic_basis.h"
#include "appliance/calibrator/photometry/ramp_blocks.h"

namespace cyclorama {
namespace {

constexpr int kIntervals = 24;
constexpr int kCamera = kIntervals + 3;
constexpr double kBend = 0.01;     // Expected change of slope per interval of the camera's curve.
constexpr double kGauge = 1e-6;    // How exactly the highest code's light is 1.
constexpr double kAnyCurve = 1.0;  // Prior on a response: it lies in [0, 1].
constexpr int kRounds = 12;
constexpr double kStartGamma = 2.2;

/// Unknowns: the camera's coefficients, then the responses between black and full. Each block's own (rest, shares) are
/// eliminated.
class ResponseFit {
 public:
  explicit ResponseFit(const RampProblem& problem) : problem_(problem), unknowns_(kCamera + problem.unknowns) {
    response_.assign(static_cast<std::size_t>(problem.unknowns), 0.0);
    for (std::size_t p = 0; p < problem.levels.size(); ++p) {
      for (std::size_t light = 0; light < 4; ++light) {
        auto at = static_cast<std::size_t>(problem.first_unknown[p].at(light));
        for (const double level : problem.levels[p].at(light)) response_[at++] = std::pow(level, kStartGamma);
      }
    }
  }

  /// The camera alone, linear: what was photographed twice had one light.
  bool start();
  /// One Gauss-Newton step for all; the largest change, or nothing when the problem has no solution.
  std::optional<double> step(bool is_robust);

  [[nodiscard]] const CameraResponse& camera() const { return camera_; }
  [[nodiscard]] double response(int unknown) const { return response_[static_cast<std::size_t>(unknown)]; }
  [[nodiscard]] double sigma(int unknown) const { return sigmas_[kCamera + unknown] * std::max(1.0, scale_); }
  [[nodiscard]] double residual() const { return residual_; }
  [[nodiscard]] bool is_finite() const { return std::isfinite(residual_) && std::isfinite(scale_); }

 private:
  void add_priors(Eigen::MatrixXd* normal, Eigen::VectorXd* right) const;
  void add_block(const RampBlock& block, bool is_robust, Eigen::MatrixXd* normal, Eigen::VectorXd* right);
  [[nodiscard]] double response_at(const RampReading& r) const {
    if (r.light < 0) return 0.0;
    return r.unknown < 0 ? 1.0 : response(r.unknown);
  }

  const RampProblem& problem_;
  int unknowns_;
  CameraResponse camera_ = CameraResponse::linear(kIntervals);
  std::vector<double> response_;
  Eigen::VectorXd sigmas_;
  double scale_ = 1.0;  ///< Of residuals over their sigmas.
  double residual_ = 0.0;
  std::vector<double> normalised_;
  double square_sum_ = 0.0;
  std::size_t count_ = 0;
};

void add_row(const CubicWeights& w, double factor, double weight, double residual, Eigen::MatrixXd* normal,
             Eigen::VectorXd* right) {
  for (int a = 0; a < 4; ++a) {
    const double wa = factor * w.value.at(static_cast<std::size_t>(a));
    (*right)(w.first + a) -= weight * wa * residual;
    for (int b = 0; b < 4; ++b)
      (*normal)(w.first + a, w.first + b) += weight * wa * factor * w.value.at(static_cast<std::size_t>(b));
  }
}

void ResponseFit::add_priors(Eigen::MatrixXd* normal, Eigen::VectorXd* right) const {
  const std::vector<double>& c = camera_.coefficients;
  for (int i = 1; i + 1 < kCamera; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const double bend = c[at - 1] - 2.0 * c[at] + c[at + 1];
    const double weight = 1.0 / (kBend * kBend);
    constexpr std::array<double, 3> kShares = {1.0, -2.0, 1.0};
    for (int a = 0; a < 3; ++a) {
      const double wa = kShares.at(static_cast<std::size_t>(a));
      (*right)(i - 1 + a) -= weight * wa * bend;
      for (int b = 0; b < 3; ++b)
        (*normal)(i - 1 + a, i - 1 + b) += weight * wa * kShares.at(static_cast<std::size_t>(b));
    }
  }
  add_row(cubic_weights(kIntervals, kIntervals), 1.0, 1.0 / (kGauge * kGauge), camera_.light_of(1.0) - 1.0, normal,
          right);
  for (int i = kCamera; i < normal->rows(); ++i) (*normal)(i, i) += 1.0 / (kAnyCurve * kAnyCurve);
}

bool ResponseFit::start() {
  for (int round = 0; round < 2; ++round) {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(unknowns_, unknowns_);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns_);
    add_priors(&normal, &right);
    for (const RampBlock& block : problem_.blocks) {
      for (std::size_t i = 0; i < block.readings.size(); ++i) {
        for (std::size_t j = i + 1; j < block.readings.size(); ++j) {
          const RampReading& a = block.readings[i];
          const RampReading& b = block.readings[j];
          if (a.light != b.light || a.unknown != b.unknown || a.exposure == b.exposure) continue;
          const RampReading& less = a.exposure < b.exposure ? a : b;
          const RampReading& more = a.exposure < b.exposure ? b : a;
          const double ratio = less.exposure / more.exposure;
          const double residual = camera_.light_of(less.code) - ratio * camera_.light_of(more.code);
          const double weight = 1.0 / (less.sigma * less.sigma + ratio * ratio * more.sigma * more.sigma);
          const CubicWeights wl = cubic_weights(less.code * kIntervals, kIntervals);
          const CubicWeights wm = cubic_weights(more.code * kIntervals, kIntervals);
          add_row(wl, 1.0, weight, residual, &normal, &right);
          add_row(wm, -ratio, weight, residual, &normal, &right);
          for (int s = 0; s < 4; ++s) {
            for (int t = 0; t < 4; ++t) {
              const double cross =
                  -ratio * weight * wl.value.at(static_cast<std::size_t>(s)) * wm.value.at(static_cast<std::size_t>(t));
              normal(wl.first + s, wm.first + t) += cross;
              normal(wm.first + t, wl.first + s) += cross;
            }
          }
        }
      }
    }
    const Eigen::VectorXd change = normal.topLeftCorner(kCamera, kCamera).ldlt().solve(right.head(kCamera));
    if (!change.allFinite()) return false;
    for (int i = 0; i < kCamera; ++i) camera_.coefficients[static_cast<std::size_t>(i)] += change(i);
  }
  return true;
}

void ResponseFit::add_block(const RampBlock& block, bool is_robust, Eigen::MatrixXd* normal, Eigen::VectorXd* right) {
  // Own unknowns: the rest, then the share of each light that was shown.
  std::array<int, 4> own{};
  int owns = 1;
  for (std::size_t light = 0; light < 4; ++light) own.at(light) = block.has_light.at(light) ? owns++ : -1;
  const auto n = static_cast<Eigen::Index>(block.readings.size());
  Eigen::MatrixXd local = Eigen::MatrixXd::Zero(n, owns);
  Eigen::VectorXd seen(n);
  Eigen::VectorXd weight(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const RampReading& r = block.readings[static_cast<std::size_t>(i)];
    local(i, 0) = -r.exposure;
    if (r.light >= 0) local(i, own.at(static_cast<std::size_t>(r.light))) = -r.exposure * response_at(r);
    seen(i) = camera_.light_of(r.code);
    const double sigma = r.sigma * std::clamp(camera_.slope_at(r.code), 0.2, 5.0);
    weight(i) = 1.0 / (sigma * sigma);
  }
  Eigen::VectorXd values;
  Eigen::VectorXd residual;
  const auto solve_own = [&] {
    Eigen::MatrixXd matrix = local.transpose() * weight.asDiagonal() * local;
    matrix.diagonal().array() += 1e-12 * matrix.diagonal().maxCoeff();
    values = matrix.ldlt().solve(-(local.transpose() * weight.cwiseProduct(seen)));
    residual = seen + local * values;
  };
  solve_own();
  if (is_robust) {
    // Cauchy's weights: somebody walks through, a lamp flickers.
    for (Eigen::Index i = 0; i < n; ++i) {
      const double ratio = residual(i) * std::sqrt(weight(i)) / (4.0 * scale_);
      weight(i) /= 1.0 + ratio * ratio;
    }
    solve_own();
  }
  Eigen::MatrixXd mixed = Eigen::MatrixXd::Zero(unknowns_, owns);
  for (Eigen::Index i = 0; i < n; ++i) {
    const RampReading& r = block.readings[static_cast<std::size_t>(i)];
    const double w = weight(i);
    normalised_.push_back(std::abs(residual(i)) * std::sqrt(w));
    square_sum_ += residual(i) * residual(i);
    ++count_;
    const CubicWeights basis = cubic_weights(r.code * kIntervals, kIntervals);
    add_row(basis, 1.0, w, residual(i), normal, right);
    for (int a = 0; a < 4; ++a)
      mixed.row(basis.first + a) += w * basis.value.at(static_cast<std::size_t>(a)) * local.row(i);
    if (r.unknown < 0) continue;
    const int at = kCamera + r.unknown;
    const double by_response = -r.exposure * values(own.at(static_cast<std::size_t>(r.light)));
    (*normal)(at, at) += w * by_response * by_response;
    (*right)(at) -= w * by_response * residual(i);
    mixed.row(at) += w * by_response * local.row(i);
    for (int a = 0; a < 4; ++a) {
      const double cross = w * by_response * basis.value.at(static_cast<std::size_t>(a));
      (*normal)(at, basis.first + a) += cross;
      (*normal)(basis.first + a, at) += cross;
    }
  }
  // The residual is orthogonal to the block's own columns, so only the matrix changes.
  Eigen::MatrixXd matrix = local.transpose() * weight.asDiagonal() * local;
  matrix.diagonal().array() += 1e-12 * matrix.diagonal().maxCoeff();
  const Eigen::LLT<Eigen::MatrixXd> factor(matrix);
  if (factor.info() != Eigen::Success) return;
  const Eigen::MatrixXd half = factor.matrixL().solve(mixed.transpose());
  normal->noalias() -= half.transpose() * half;
}

std::optional<double> ResponseFit::step(bool is_robust) {
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(unknowns_, unknowns_);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns_);
  normalised_.clear();
  square_sum_ = 0.0;
  count_ = 0;
  add_priors(&normal, &right);
  for (const RampBlock& block : problem_.blocks) add_block(block, is_robust, &normal, &right);
  const Eigen::LDLT<Eigen::MatrixXd> factor(normal);
  const Eigen::VectorXd change = factor.solve(right);
  if (!change.allFinite()) return std::nullopt;
  for (int i = 0; i < kCamera; ++i) camera_.coefficients[static_cast<std::size_t>(i)] += change(i);
  double largest = 0.0;
  for (int i = 0; i < problem_.unknowns; ++i) {
    response_[static_cast<std::size_t>(i)] += change(kCamera + i);
    largest = std::max(largest, std::abs(change(kCamera + i)));
  }
  residual_ = std::sqrt(square_sum_ / static_cast<double>(std::max<std::size_t>(count_, 1)));
  const auto middle = normalised_.begin() + static_cast<std::ptrdiff_t>(normalised_.size() / 2);
  std::nth_element(normalised_.begin(), middle, normalised_.end());
  scale_ = std::max(0.1, 1.4826 * *middle);
  sigmas_ = factor.solve(Eigen::MatrixXd::Identity(unknowns_, unknowns_)).diagonal().cwiseMax(0.0).cwiseSqrt();
  return largest;
}

}  // namespace

Result<SolvedResponses> solve_responses(const PhotometryInput& input) {
  TRY_ASSIGN(const RampProblem problem, ramp_problem(input));
  const Error unsolved(ErrorCode::kBadData,
                       "the ramps contradict each other; look whether the camera's exposure and gain stand still and "
                       "nobody walked through, then photograph them again");
  ResponseFit fit(problem);
  if (!fit.start()) return unsolved;
  for (int round = 0; round < kRounds; ++round) {
    const auto change = fit.step(round >= 3);
    if (!change) return unsolved;
    if (round >= 5 && *change < 1e-6) break;
  }
  if (!fit.is_finite()) return unsolved;
  SolvedResponses solved;
  solved.camera = fit.camera();
  solved.residual = fit.residual();
  for (std::size_t p = 0; p < input.projectors.size(); ++p) {
    auto& channels = solved.channels.emplace_back();
    for (std::size_t light = 0; light < 3; ++light) {
      channels.at(light).push_back({0.0, 0.0, 0.0});
      int unknown = problem.first_unknown[p].at(light);
      for (const double level : problem.levels[p].at(light)) {
        channels.at(light).push_back({level, fit.response(unknown), fit.sigma(unknown)});
        ++unknown;
      }
      channels.at(light).push_back({1.0, 1.0, 0.0});
    }
  }
  return solved;
}

}  // namespace cyclorama
