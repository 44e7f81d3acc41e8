// SPDX-License-Identifier: Apache-2.0
#include "appliance/photometry/response_solve.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>

#include "appliance/photometry/cubic_basis.h"
#include "appliance/photometry/ramp_blocks.h"

namespace cyclorama::photometry {
namespace {

constexpr int kIntervals = 24;
constexpr int kCamera = kIntervals + 3;
// Priors of the camera's curve: expected second and third difference per interval. With only two exposures, an
// oscillation with the period of their ratio would be undetermined.
constexpr double kBend = 0.02;
constexpr double kTwist = 7e-5;
constexpr double kGauge = 1e-6;    // Tolerance of the constraint on the unit of light.
constexpr double kAnyCurve = 1.0;  // Prior sigma of a response, which lies in [0, 1].
constexpr int kRounds = 20;
constexpr int kStartRounds = 5;
constexpr double kConverged = 1e-6;

/// Returns the weight of a residual; outliers, as when somebody walks through or a lamp flickers, have small weights.
/// If `scale` is 0, the weight is 1.
double cauchy_weight(double normalised, double scale) {
  if (!(scale > 0.0)) return 1.0;
  const double ratio = normalised / (4.0 * scale);
  return 1.0 / (1.0 + ratio * ratio);
}

/// Returns a robust standard deviation from absolute values, at least 0.1.
double scale_of(std::vector<double>* magnitudes) {
  if (magnitudes->empty()) return 1.0;
  const auto middle = magnitudes->begin() + static_cast<std::ptrdiff_t>(magnitudes->size() / 2);
  std::nth_element(magnitudes->begin(), middle, magnitudes->end());
  return std::max(0.1, 1.4826 * *middle);
}

/// Fit of the responses. The unknowns are the camera's coefficients, then the responses at intermediate levels; each
/// block's unknowns (rest, shares) are eliminated.
class ResponseFit {
 public:
  explicit ResponseFit(const RampProblem& problem)
      : problem_(problem),
        unknowns_(kCamera + problem.unknowns),
        response_(static_cast<std::size_t>(problem.unknowns), 0.0),
        gauge_(gauge_of(problem)) {}

  /// Solves for the camera alone, then computes the responses with that camera curve. The camera's problem is linear,
  /// because two photographs of the same light differ only in exposure.
  bool start();
  /// Estimates the scale of the residuals before the first step.
  void find_scale();
  /// Performs one Gauss-Newton step over all unknowns. Returns the largest change, or nothing if the problem has no
  /// solution.
  std::optional<double> step();

  /// Returns the camera's response, scaled so that the light of the highest code is 1; residual() has the same unit.
  [[nodiscard]] CameraResponse camera() const {
    CameraResponse camera = camera_;
    for (double& coefficient : camera.coefficients) coefficient /= camera_.light_of(1.0);
    return camera;
  }
  [[nodiscard]] double response(int unknown) const { return response_[static_cast<std::size_t>(unknown)]; }
  [[nodiscard]] double sigma(int unknown) const { return sigmas_[kCamera + unknown] * std::max(1.0, scale_); }
  [[nodiscard]] double residual() const { return residual_ / camera_.light_of(1.0); }
  [[nodiscard]] bool is_finite() const {
    return std::isfinite(residual_) && std::isfinite(scale_) && camera_.light_of(1.0) > 0.0;
  }

 private:
  bool start_camera();
  void start_responses();
  void add_priors(Eigen::MatrixXd* normal, Eigen::VectorXd* right) const;
  template <std::size_t N>
  void add_difference(int first, const std::array<double, N>& shares, double sigma, Eigen::MatrixXd* normal,
                      Eigen::VectorXd* right) const;
  void add_block(const RampBlock& block, Eigen::MatrixXd* normal, Eigen::VectorXd* right);
  [[nodiscard]] double response_at(const RampReading& r) const {
    if (r.light < 0) return 0.0;
    return r.unknown < 0 ? 1.0 : response(r.unknown);
  }

  /// Returns the constraint that fixes the unit of light: over all readings, the sum of light times code equals that of
  /// code squared. The readings must determine the unit: residuals are in light, so the curve would otherwise shrink at
  /// the readings, together with their noise.
  static Eigen::VectorXd gauge_of(const RampProblem& problem);

  const RampProblem& problem_;
  int unknowns_;
  CameraResponse camera_ = CameraResponse::linear(kIntervals);
  std::vector<double> response_;
  Eigen::VectorXd gauge_;
  Eigen::VectorXd sigmas_;
  double scale_ = 0.0;  ///< Scale of the residuals relative to their sigmas; 0 if not known yet.
  double prior_scale_ = 1.0;
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

Eigen::VectorXd ResponseFit::gauge_of(const RampProblem& problem) {
  Eigen::VectorXd gauge = Eigen::VectorXd::Zero(kCamera);
  double squares = 0.0;
  for (const RampBlock& block : problem.blocks) {
    for (const RampReading& r : block.readings) {
      const CubicWeights basis = cubic_weights(r.code * kIntervals, kIntervals);
      for (int a = 0; a < 4; ++a) gauge(basis.first + a) += r.code * basis.value.at(static_cast<std::size_t>(a));
      squares += r.code * r.code;
    }
  }
  return gauge / std::max(squares, 1e-12);
}

template <std::size_t N>
void ResponseFit::add_difference(int first, const std::array<double, N>& shares, double sigma, Eigen::MatrixXd* normal,
                                 Eigen::VectorXd* right) const {
  double difference = 0.0;
  for (std::size_t a = 0; a < N; ++a)
    difference += shares.at(a) * camera_.coefficients[static_cast<std::size_t>(first) + a];
  // If the readings are noisier than their sigmas, the priors' weights increase accordingly.
  const double scale = std::max(1.0, prior_scale_);
  const double weight = scale * scale / (sigma * sigma);
  for (std::size_t a = 0; a < N; ++a) {
    const int row = first + static_cast<int>(a);
    (*right)(row) -= weight * shares.at(a) * difference;
    for (std::size_t b = 0; b < N; ++b)
      (*normal)(row, first + static_cast<int>(b)) += weight * shares.at(a) * shares.at(b);
  }
}

void ResponseFit::add_priors(Eigen::MatrixXd* normal, Eigen::VectorXd* right) const {
  constexpr std::array<double, 3> kSecond = {1.0, -2.0, 1.0};
  constexpr std::array<double, 4> kThird = {1.0, -3.0, 3.0, -1.0};
  for (int i = 0; i + 3 <= kCamera; ++i) add_difference(i, kSecond, kBend, normal, right);
  for (int i = 0; i + 4 <= kCamera; ++i) {
    // Camera curves are about powers of the light, so they are straighter at bright codes.
    const double code = std::max(0.5, i + 0.5) / kIntervals;
    const double darkness = std::max(1.0, 0.3 / code);
    add_difference(i, kThird, kTwist * darkness * darkness, normal, right);
  }
  const Eigen::Map<const Eigen::VectorXd> coefficients(camera_.coefficients.data(), kCamera);
  const double weight = 1.0 / (kGauge * kGauge);
  right->head(kCamera) -= weight * (gauge_.dot(coefficients) - 1.0) * gauge_;
  normal->topLeftCorner(kCamera, kCamera) += weight * gauge_ * gauge_.transpose();
  for (int i = kCamera; i < normal->rows(); ++i) (*normal)(i, i) += 1.0 / (kAnyCurve * kAnyCurve);
}

bool ResponseFit::start() {
  if (!start_camera()) return false;
  start_responses();
  return true;
}

void ResponseFit::start_responses() {
  struct Mean {
    double sum = 0.0;
    double weight = 0.0;
    void add(double value, double w) {
      sum += w * value;
      weight += w;
    }
    [[nodiscard]] double value() const { return weight > 0.0 ? sum / weight : 0.0; }
  };
  std::vector<Mean> products(response_.size());
  for (const RampBlock& block : problem_.blocks) {
    // Readings are weighted by exposure over sigma, so long exposures count most.
    Mean rest;
    std::array<Mean, 4> share;
    const auto light_of = [this](const RampReading& r) { return camera_.light_of(r.code) / r.exposure; };
    const auto weight_of = [](const RampReading& r) { return std::pow(r.exposure / r.sigma, 2); };
    for (const RampReading& r : block.readings) {
      if (r.light < 0) rest.add(light_of(r), weight_of(r));
    }
    for (const RampReading& r : block.readings) {
      if (r.light >= 0 && r.unknown < 0)
        share.at(static_cast<std::size_t>(r.light)).add(light_of(r) - rest.value(), weight_of(r));
    }
    for (const RampReading& r : block.readings) {
      if (r.unknown < 0) continue;
      const double full = share.at(static_cast<std::size_t>(r.light)).value();
      Mean& product = products[static_cast<std::size_t>(r.unknown)];
      product.sum += weight_of(r) * full * (light_of(r) - rest.value());
      product.weight += weight_of(r) * full * full;
    }
  }
  for (std::size_t i = 0; i < products.size(); ++i) response_[i] = std::clamp(products[i].value(), -0.1, 1.5);
}

bool ResponseFit::start_camera() {
  double scale = 0.0;  // Scale of the residuals; 0 until it is known.
  for (int round = 0; round < kStartRounds; ++round) {
    std::vector<double> normalised;
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
          const double variance = less.sigma * less.sigma + ratio * ratio * more.sigma * more.sigma;
          normalised.push_back(std::abs(residual) / std::sqrt(variance));
          const double weight = cauchy_weight(normalised.back(), scale) / variance;
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
    scale = scale_of(&normalised);
    prior_scale_ = scale;
  }
  return true;
}

void ResponseFit::add_block(const RampBlock& block, Eigen::MatrixXd* normal, Eigen::VectorXd* right) {
  // The block's unknowns are the rest, then the share of each light that was shown.
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
    // Weights follow from the sigma of the code, not of the light: weights that depend on the curve's slope would
    // flatten the curve, round by round.
    weight(i) = 1.0 / (r.sigma * r.sigma);
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
  const Eigen::VectorXd full = weight;
  // Iterated, because a disturbed reading affects the others' residuals at first.
  for (int round = 0; round < 3 && scale_ > 0.0; ++round) {
    for (Eigen::Index i = 0; i < n; ++i)
      weight(i) = full(i) * cauchy_weight(std::abs(residual(i)) * std::sqrt(full(i)), scale_);
    solve_own();
  }
  Eigen::MatrixXd mixed = Eigen::MatrixXd::Zero(unknowns_, owns);
  for (Eigen::Index i = 0; i < n; ++i) {
    const RampReading& r = block.readings[static_cast<std::size_t>(i)];
    const double w = weight(i);
    normalised_.push_back(std::abs(residual(i)) * std::sqrt(full(i)));
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
  // The residual is orthogonal to the block's columns, so the elimination changes only the matrix.
  Eigen::MatrixXd matrix = local.transpose() * weight.asDiagonal() * local;
  matrix.diagonal().array() += 1e-12 * matrix.diagonal().maxCoeff();
  const Eigen::LLT<Eigen::MatrixXd> factor(matrix);
  if (factor.info() != Eigen::Success) return;
  const Eigen::MatrixXd half = factor.matrixL().solve(mixed.transpose());
  normal->noalias() -= half.transpose() * half;
}

void ResponseFit::find_scale() {
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(unknowns_, unknowns_);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns_);
  normalised_.clear();
  for (const RampBlock& block : problem_.blocks) add_block(block, &normal, &right);
  prior_scale_ = scale_ = scale_of(&normalised_);
}

std::optional<double> ResponseFit::step() {
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(unknowns_, unknowns_);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns_);
  normalised_.clear();
  square_sum_ = 0.0;
  count_ = 0;
  add_priors(&normal, &right);
  for (const RampBlock& block : problem_.blocks) add_block(block, &normal, &right);
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
  prior_scale_ = scale_ = scale_of(&normalised_);
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
  fit.find_scale();
  for (int round = 0; round < kRounds; ++round) {
    const auto change = fit.step();
    if (!change) return unsolved;
    if (*change < kConverged) break;
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

}  // namespace cyclorama::photometry
