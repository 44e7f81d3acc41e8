// SPDX-License-Identifier: Apache-2.0
#include "appliance/solve/map_fit.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "appliance/calibration/direction_chart.h"
#include "appliance/calibration/map_grid.h"
#include "appliance/solve/map_normal.h"
#include "appliance/solve/selected_inverse.h"

namespace cyclorama::solve {
namespace {

constexpr double kFloor_px = 0.02;  // Added to a sample's sigma: error that averaging does not reduce.
constexpr double kRobust_sigmas = 3.0;
constexpr double kSharpBends = 2.0;  // Multiple of the expected bend above which a bend is down-weighted.
constexpr std::array<double, 5> kStiffnesses_px = {0.01, 0.03, 0.1, 0.3, 1.0};
constexpr int kAttempt = 2;  // Index of the initial stiffness.
constexpr double kAttempt_px = kStiffnesses_px[kAttempt];

struct Placed {
  calibration::GridWeights weights;
  Eigen::Vector2d target;  ///< Position in the chart.
  double sigma_px = 0.0;
  bool is_left_out = false;
};

class MapFit {
 public:
  MapFit(const calibration::MapGrid& grid, std::vector<Placed> samples, double scale)
      : grid_(grid), samples_(std::move(samples)), bends_(bends_of(grid)), normal_(grid, bends_) {
    scale_.assign(static_cast<std::size_t>(grid_.nodes()), scale);
    sample_trust_.assign(samples_.size(), 1.0);
    bend_trust_.assign(bends_.size(), 1.0);
    sum(false);
    factor_.analyzePattern(normal_.at_stiffness(kAttempt_px));
  }

  /// Sums the weighted equations for solve().
  void sum(bool with_left_out) {
    normal_.forget_samples();
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const Placed& sample = samples_[i];
      if (sample.is_left_out && !with_left_out) continue;
      normal_.add(sample.weights, sample.target, sample_trust_[i] / square(sample.sigma_px * scale_at(sample.weights)));
    }
    normal_.forget_bends();
    for (std::size_t i = 0; i < bends_.size(); ++i) {
      const double scale = scale_[static_cast<std::size_t>(bends_[i].nodes[1])];
      normal_.add(bends_[i], bend_trust_[i] / square(scale));
    }
  }

  /// Returns false if the matrix cannot be factored.
  bool solve(double stiffness_px) {
    factor_.factorize(normal_.at_stiffness(stiffness_px));
    if (factor_.info() != Eigen::Success) return false;
    positions_ = factor_.solve(normal_.right());
    return positions_.allFinite();
  }

  /// Updates, from the last solution, the robust weights of all samples and bends, and the chart's scale at each node.
  void weigh(double stiffness_px) {
    for (int y = 0; y <= grid_.cells_y; ++y) {
      for (int x = 0; x <= grid_.cells_x; ++x) {
        const int left = grid_.node(std::max(0, x - 1), y);
        const int right = grid_.node(std::min(grid_.cells_x, x + 1), y);
        const int above = grid_.node(x, std::max(0, y - 1));
        const int below = grid_.node(x, std::min(grid_.cells_y, y + 1));
        const Eigen::Vector2d across =
            (positions_.row(right) - positions_.row(left)).transpose() / ((right - left) * grid_.cell_width());
        const Eigen::Vector2d down = (positions_.row(below) - positions_.row(above)).transpose() /
                                     ((below - above) / (grid_.cells_x + 1) * grid_.cell_height());
        const double area = std::abs(across.x() * down.y() - across.y() * down.x());
        auto& scale = scale_[static_cast<std::size_t>(grid_.node(x, y))];
        // Limited to a factor of eight per round, since a map is arbitrary far outside the samples.
        if (std::isfinite(area)) scale = std::clamp(std::sqrt(area), scale / 8.0, scale * 8.0);
      }
    }
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const double sigmas = error_px(samples_[i]) / samples_[i].sigma_px;
      sample_trust_[i] = 1.0 / (1.0 + square(sigmas / kRobust_sigmas));
    }
    for (std::size_t i = 0; i < bends_.size(); ++i) {
      const Bend& bend = bends_[i];
      Eigen::Vector2d sum = Eigen::Vector2d::Zero();
      for (int a = 0; a < bend.count; ++a) {
        sum += bend.factors[static_cast<std::size_t>(a)] *
               positions_.row(bend.nodes[static_cast<std::size_t>(a)]).transpose();
      }
      const double bends = sum.norm() / (stiffness_px * scale_[static_cast<std::size_t>(bend.nodes[1])]);
      bend_trust_[i] = bends > kSharpBends ? kSharpBends / bends : 1.0;
    }
  }

  [[nodiscard]] double error_px(const Placed& sample) const {
    Eigen::Vector2d mapped = Eigen::Vector2d::Zero();
    for (std::size_t a = 0; a < 3; ++a) {
      mapped += sample.weights.factors[a] * positions_.row(sample.weights.nodes[a]).transpose();
    }
    return (mapped - sample.target).norm() / scale_at(sample.weights);
  }

  /// Returns the RMS over the left-out samples, per axis, without the worst twentieth.
  [[nodiscard]] double left_out_rms_px() const {
    std::vector<double> squares;
    for (const Placed& sample : samples_) {
      if (sample.is_left_out) squares.push_back(0.5 * square(error_px(sample)));
    }
    return trimmed_root_mean(&squares);
  }

  /// Returns the RMS over all samples in sigmas, per axis, without the worst twentieth.
  [[nodiscard]] double chi() const {
    std::vector<double> squares;
    for (const Placed& sample : samples_) squares.push_back(0.5 * square(error_px(sample) / sample.sigma_px));
    return trimmed_root_mean(&squares);
  }

  /// Returns, for each node, the distance in cells to the nearest node with a sample of sufficient weight.
  [[nodiscard]] std::vector<int> cells_from_samples() const {
    constexpr double kBelieved = 0.2;
    std::vector<int> steps(static_cast<std::size_t>(grid_.nodes()), -1);
    std::vector<int> rim;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      if (sample_trust_[i] < kBelieved) continue;
      for (const int node : samples_[i].weights.nodes) {
        if (steps[static_cast<std::size_t>(node)] < 0) rim.push_back(node);
        steps[static_cast<std::size_t>(node)] = 0;
      }
    }
    for (int step = 1; !rim.empty(); ++step) {
      std::vector<int> next;
      for (const int node : rim) {
        const int x = node % (grid_.cells_x + 1);
        const int y = node / (grid_.cells_x + 1);
        for (int v = std::max(0, y - 1); v <= std::min(grid_.cells_y, y + 1); ++v) {
          for (int u = std::max(0, x - 1); u <= std::min(grid_.cells_x, x + 1); ++u) {
            int& at = steps[static_cast<std::size_t>(grid_.node(u, v))];
            if (at < 0) next.push_back(grid_.node(u, v));
            if (at < 0) at = step;
          }
        }
      }
      rim = std::move(next);
    }
    return steps;
  }

  [[nodiscard]] const Eigen::MatrixX2d& positions() const { return positions_; }
  [[nodiscard]] std::vector<double> sigmas_px() const {
    std::vector<double> sigmas = inverse_diagonal(factor_);
    for (std::size_t i = 0; i < sigmas.size(); ++i) sigmas[i] = std::sqrt(std::max(0.0, sigmas[i])) / scale_[i];
    return sigmas;
  }

  static double trimmed_root_mean(std::vector<double>* squares) {
    if (squares->empty()) return 0.0;
    std::sort(squares->begin(), squares->end());
    squares->resize(squares->size() - squares->size() / 20);
    double sum = 0.0;
    for (const double s : *squares) sum += s;
    return std::sqrt(sum / static_cast<double>(squares->size()));
  }

 private:
  static double square(double x) { return x * x; }
  [[nodiscard]] double scale_at(const calibration::GridWeights& weights) const {
    return scale_[static_cast<std::size_t>(weights.nodes[0])];
  }

  const calibration::MapGrid grid_;
  std::vector<Placed> samples_;
  std::vector<Bend> bends_;
  MapNormal normal_;
  std::vector<double> scale_;  ///< Chart units per projector pixel, at each node.
  std::vector<double> sample_trust_;
  std::vector<double> bend_trust_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
  Eigen::MatrixX2d positions_;
};

/// Returns the chart units per pixel over all samples; 0 if the samples are collinear.
double overall_scale(const std::vector<Placed>& placed, std::span<const MapSample> samples) {
  Eigen::Vector2d pixel_mean = Eigen::Vector2d::Zero();
  Eigen::Vector2d target_mean = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < placed.size(); ++i) {
    pixel_mean += samples[i].projector_px;
    target_mean += placed[i].target;
  }
  pixel_mean /= static_cast<double>(placed.size());
  target_mean /= static_cast<double>(placed.size());
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  Eigen::Matrix2d cross = Eigen::Matrix2d::Zero();
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const Eigen::Vector2d p = samples[i].projector_px - pixel_mean;
    spread += p * p.transpose();
    cross += (placed[i].target - target_mean) * p.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(spread);
  if (!(eigen.eigenvalues()(0) > 1e-4 * eigen.eigenvalues()(1))) return 0.0;
  return std::sqrt(std::abs((cross * spread.inverse()).determinant()));
}

/// Returns the stiffness with the smallest error of left-out samples, and this error in pixels. As a function of the
/// stiffness the error has one minimum, so the search descends from the initial stiffness.
std::pair<double, double> best_stiffness_of(MapFit* fit) {
  const auto error_at = [&](int i) {
    if (i < 0 || i >= static_cast<int>(kStiffnesses_px.size())) return std::numeric_limits<double>::infinity();
    const bool is_solved = fit->solve(kStiffnesses_px[static_cast<std::size_t>(i)]);
    return is_solved ? fit->left_out_rms_px() : std::numeric_limits<double>::infinity();
  };
  int best = kAttempt;
  double min = error_at(best);
  for (const int step : {-1, 1}) {
    bool is_falling = true;
    while (is_falling) {
      const double error = error_at(best + step);
      is_falling = error < min;
      if (is_falling) best += step;
      if (is_falling) min = error;
    }
    if (best != kAttempt) break;  // If the error falls to one side, it rises to the other.
  }
  return {kStiffnesses_px[static_cast<std::size_t>(best)], min};
}

Error refused(std::string what) { return Error(ErrorCode::kInvalidArgument, std::move(what)); }

}  // namespace

Result<calibration::MeasuredMap> fit_measured_map(int width_px, int height_px, std::span<const MapSample> samples,
                                                  const MapOptions& options) {
  CHECK(width_px > 0 && height_px > 0 && options.cell_px > 0);
  if (samples.size() < options.min_samples) {
    return refused(
        fmt::format("{} places of the projector's picture were seen, {} are needed; look whether it shines "
                    "onto the wall, and add a direction towards it",
                    samples.size(), options.min_samples));
  }
  calibration::MapGrid grid{width_px, height_px, std::max(1, (width_px + options.cell_px / 2) / options.cell_px),
                            std::max(1, (height_px + options.cell_px / 2) / options.cell_px)};
  const auto chart = calibration::DirectionChart::around(samples);
  if (!chart) return refused("the projector's picture goes round the sweet spot; move the sweet spot off its light");
  std::vector<Placed> placed;
  std::vector<MapSample> kept;
  const int block_px = 2 * options.cell_px;
  for (const MapSample& sample : samples) {
    const auto weights = grid.weights_at(sample.projector_px);
    const auto position = chart->place_of(sample.direction);
    if (!weights || !position || !(sample.sigma_px > 0.0)) continue;
    // A fixed hash scatters the left-out blocks, which are the same in all directions of the turntable.
    const auto column = static_cast<unsigned>(sample.projector_px.x()) / static_cast<unsigned>(block_px);
    const auto row = static_cast<unsigned>(sample.projector_px.y()) / static_cast<unsigned>(block_px);
    const unsigned hash = (column * 2654435761U) ^ (row * 2246822519U);
    const bool is_left_out = (hash >> 7) % static_cast<unsigned>(options.left_out_every) == 0;
    placed.push_back({*weights, *position, std::hypot(sample.sigma_px, kFloor_px), is_left_out});
    kept.push_back(sample);
  }
  const double scale = placed.size() < options.min_samples ? 0.0 : overall_scale(placed, kept);
  if (!(scale > 1e-9) || !std::isfinite(scale)) {
    return refused("the places seen of the projector's picture lie on a line; look what hides the rest of it");
  }
  MapFit fit(grid, std::move(placed), scale);
  const Error unsolved(ErrorCode::kBadData, "the map has no solution; decode again with more light");
  for (int round = 0; round < 3; ++round) {
    if (!fit.solve(kAttempt_px)) return unsolved;
    fit.weigh(kAttempt_px);
    fit.sum(false);
  }
  const auto [best_stiffness, best_error] = best_stiffness_of(&fit);
  for (int round = 0; round < 2; ++round) {
    fit.sum(true);
    if (!fit.solve(best_stiffness)) return unsolved;
    if (round == 0) fit.weigh(best_stiffness);
  }
  calibration::MeasuredMap map{width_px,        height_px,  grid.cells_x,   grid.cells_y, {},
                               fit.sigmas_px(), best_error, best_stiffness, kept.size()};
  const double chi = std::max(1.0, fit.chi());
  const Eigen::Vector3d none = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  const std::vector<int> steps = fit.cells_from_samples();
  int measured = 0;
  for (int i = 0; i < grid.nodes(); ++i) {
    double& sigma = map.sigma_px[static_cast<std::size_t>(i)];
    sigma *= chi;
    const auto direction = chart->direction_of(fit.positions().row(i).transpose());
    const bool is_near = steps[static_cast<std::size_t>(i)] >= 0 &&
                         steps[static_cast<std::size_t>(i)] * options.cell_px <= options.max_gap_px;
    const bool is_good = direction && is_near && sigma <= options.max_sigma_px;
    map.directions.push_back(is_good ? *direction : none);
    if (!is_good) sigma = std::numeric_limits<double>::infinity();
    measured += is_good ? 1 : 0;
  }
  if (measured == 0) return refused("no place of the projector's picture is known well; take more pictures of it");
  return map;
}

double known_part(const calibration::MeasuredMap& map, std::span<const MapSample> samples) {
  if (samples.empty()) return 0.0;
  const auto known = std::ranges::count_if(
      samples, [&](const MapSample& sample) { return map.direction_at(sample.projector_px).has_value(); });
  return static_cast<double>(known) / static_cast<double>(samples.size());
}

std::optional<double> map_error_px(const calibration::MeasuredMap& map, std::span<const MapSample> samples) {
  constexpr double kStep_px = 1.0;
  std::vector<double> squares;
  for (const MapSample& sample : samples) {
    const Eigen::Vector2d p = sample.projector_px;
    const auto at = map.direction_at(p);
    const auto across = map.direction_at(p + Eigen::Vector2d(kStep_px, 0.0));
    const auto down = map.direction_at(p + Eigen::Vector2d(0.0, kStep_px));
    if (!at || !across || !down) continue;
    Eigen::Matrix<double, 3, 2> slope;
    slope << (*across - *at) / kStep_px, (*down - *at) / kStep_px;
    const Eigen::Matrix2d normal = slope.transpose() * slope;
    if (!(std::abs(normal.determinant()) > 1e-300)) continue;
    const double square = 0.5 * (normal.inverse() * slope.transpose() * (sample.direction - *at)).squaredNorm();
    if (std::isfinite(square)) squares.push_back(square);
  }
  if (squares.empty() || 2 * squares.size() < samples.size()) return std::nullopt;
  return MapFit::trimmed_root_mean(&squares);
}

}  // namespace cyclorama::solve
