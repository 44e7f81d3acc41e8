// SPDX-License-Identifier: Apache-2.0
/// Pearson's chi-square test of random numbers, also for samplers of directions. Sources: Press et al., "Numerical
/// Recipes", 3rd edition, sections 6.2 and 14.3; Šidák, "Rectangular Confidence Regions for the Means of Multivariate
/// Normal Distributions", 1967.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "renderfarm/render/vectors.h"

namespace cyclorama {

struct ChiSquare {
  double statistic = 0.0;
  int degrees = 0;
  double p_value = 1.0;  ///< Probability that chance alone yields a statistic at least as large.
};

/// Returns the probability that a chi-square variable is at least `statistic`: Q(degrees / 2, statistic / 2), the
/// regularised upper incomplete gamma function, by its series below the mean and its continued fraction above.
[[nodiscard]] inline double chi_square_p_value(double statistic, int degrees) {
  if (!(statistic > 0.0) || degrees < 1) return std::isnan(statistic) ? 0.0 : 1.0;
  if (std::isinf(statistic)) return 0.0;
  constexpr double kPrecision = 1e-14;
  constexpr double kTiny = 1e-300;
  constexpr int kMaxTerms = 100000;
  const double a = 0.5 * degrees;
  const double x = 0.5 * statistic;
  const double scale = std::exp(a * std::log(x) - x - std::lgamma(a));
  if (x < a + 1.0) {
    double term = 1.0 / a;
    double sum = term;
    for (int n = 1; n < kMaxTerms && term > sum * kPrecision; ++n) {
      term *= x / (a + n);
      sum += term;
    }
    return std::clamp(1.0 - sum * scale, 0.0, 1.0);
  }
  double b = x + 1.0 - a;
  double c = 1.0 / kTiny;
  double d = 1.0 / b;
  double fraction = d;
  for (int n = 1; n < kMaxTerms; ++n) {
    const double factor = n * (a - n);
    b += 2.0;
    const double bottom = factor * d + b;
    d = 1.0 / (std::abs(bottom) < kTiny ? kTiny : bottom);
    c = b + factor / c;
    if (std::abs(c) < kTiny) c = kTiny;
    fraction *= d * c;
    if (std::abs(d * c - 1.0) < kPrecision) break;
  }
  return std::clamp(fraction * scale, 0.0, 1.0);
}

/// Returns the significance level of each of `tests` independent tests with which all together raise a false alarm with
/// probability `alpha`.
[[nodiscard]] inline double sidak(double alpha, int tests) { return -std::expm1(std::log1p(-alpha) / tests); }

/// Compares counts with expected counts of the same total. Bins with an expectation below five are pooled.
[[nodiscard]] inline ChiSquare chi_square(std::span<const double> observed, std::span<const double> expected) {
  constexpr double kMinExpected = 5.0;
  ChiSquare result;
  double pool_observed = 0.0;
  double pool_expected = 0.0;
  int bins = 0;
  const auto count = [&](double o, double e) {
    result.statistic += (o - e) * (o - e) / e;
    ++bins;
  };
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (!(expected[i] > 0.0) && observed[i] > 0.0) return {std::numeric_limits<double>::infinity(), 1, 0.0};
    if (expected[i] >= kMinExpected) {
      count(observed[i], expected[i]);
    } else {
      pool_observed += observed[i];
      pool_expected += expected[i];
    }
  }
  // A small pool can reveal an excess but not a deficit.
  if (pool_expected >= kMinExpected || pool_observed > pool_expected)
    count(pool_observed, std::max(pool_expected, 1.0));
  result.degrees = std::max(1, bins - 1);
  result.p_value = chi_square_p_value(result.statistic, result.degrees);
  return result;
}

/// Counts directions in bins, which are rectangles in height along x and angle about x. A pilot run defines the bins:
/// they are split at its median and cropped where it has no directions. Its directions also guide the integration to
/// narrow lobes and small lamps. Thread-bound.
class SphereHistogram {
 public:
  /// Makes 2^depth bins, and more for the regions without pilot directions. `pilot` may be empty; its directions must
  /// not be counted again.
  explicit SphereHistogram(const std::vector<render::Vec3>& pilot, int depth = 7) {
    std::vector<std::array<double, 2>> points;
    points.reserve(pilot.size());
    for (const render::Vec3& direction : pilot) points.push_back(coordinates(direction));
    grow({{-1.0, -std::numbers::pi}, {1.0, std::numbers::pi}}, points, depth);
    counts_.resize(bins_.size() + 1, 0.0);
  }

  void add(const render::Vec3& direction) {
    const std::array<double, 2> at = coordinates(direction);
    std::size_t node = 0;
    while (nodes_[node].above != 0) node = at[nodes_[node].axis] < nodes_[node].place ? node + 1 : nodes_[node].above;
    counts_[nodes_[node].bin] += 1.0;
    total_ += 1.0;
  }
  /// Counts a sample without a direction, or a sample that the pdf excludes, as part of the total.
  void add_lost() {
    counts_.back() += 1.0;
    total_ += 1.0;
  }
  [[nodiscard]] double lost() const { return total_ > 0.0 ? counts_.back() / total_ : 0.0; }

  /// Returns the probability of each bin: the integral of pdf(Vec3), which is per steradian.
  template <typename Density>
  [[nodiscard]] std::vector<double> integrate(const Density& pdf) const {
    std::vector<double> probabilities;
    probabilities.reserve(bins_.size());
    for (const Bin& bin : bins_) {
      std::vector<Probe> probes;
      for (const std::array<double, 2>& at : bin.pilot) probes.push_back({at, value_at(pdf, at[0], at[1])});
      probabilities.push_back(refined(pdf, bin.place, gauss(pdf, bin.place), probes, 0));
    }
    return probabilities;
  }

  /// Tests whether the counts follow pdf(Vec3). If the pdf integrates to less than one, the rest is the expected share
  /// of lost samples.
  template <typename Density>
  [[nodiscard]] ChiSquare compare(const Density& pdf, double* ret_integral = nullptr) const {
    constexpr double kMinExpected = 1e-3;
    std::vector<double> expected = integrate(pdf);
    double sum = 0.0;
    for (double& e : expected) {
      sum += e;
      e = std::max(e * total_, kMinExpected);  // A seemingly empty bin may contain the end of a tail.
    }
    if (ret_integral != nullptr) *ret_integral = sum;
    expected.push_back(std::max((1.0 - sum) * total_, kMinExpected));
    return chi_square(counts_, expected);
  }

 private:
  struct Rectangle {
    std::array<double, 2> low{};
    std::array<double, 2> high{};
  };
  struct Bin {
    Rectangle place;
    std::vector<std::array<double, 2>> pilot;
  };
  /// A position and the pdf there.
  struct Probe {
    std::array<double, 2> at{};
    double pdf = 0.0;
  };
  /// A node of the tree of bins. Its lower child directly follows it.
  struct Node {
    std::size_t axis = 0;
    double place = 0.0;
    std::size_t above = 0;  ///< Index of the upper child; zero for a leaf.
    std::size_t bin = 0;
  };
  using Points = std::span<std::array<double, 2>>;

  static std::array<double, 2> coordinates(const render::Vec3& v) {
    const Eigen::Vector3d d = v.cast<double>().normalized();
    return {d.x(), std::atan2(d.z(), d.y())};
  }

  void split(const Rectangle& r, std::size_t axis, double place, std::pair<Points, Points> points,
             std::pair<int, int> depths) {
    const std::size_t node = nodes_.size();
    nodes_.push_back({axis, place, 0, 0});
    Rectangle below = r;
    Rectangle above = r;
    below.high[axis] = above.low[axis] = place;
    grow(below, points.first, depths.first);
    nodes_[node].above = nodes_.size();
    grow(above, points.second, depths.second);
  }

  void grow(const Rectangle& r, Points points, int depth) {
    for (std::size_t axis = 0; axis < 2 && points.size() > 1; ++axis) {
      const auto less = [axis](const auto& a, const auto& b) { return a[axis] < b[axis]; };
      const auto [first, last] = std::minmax_element(points.begin(), points.end(), less);
      const double margin = 0.1 * ((*last)[axis] - (*first)[axis]);
      const double empty = 0.5 * (r.high[axis] - r.low[axis]);
      const double from = (*first)[axis] - margin;
      const double to = (*last)[axis] + margin;
      if (from - r.low[axis] > empty) return split(r, axis, from, {{}, points}, {0, depth});
      if (r.high[axis] - to > empty) return split(r, axis, to, {points, {}}, {depth, 0});
    }
    if (depth == 0) {
      nodes_.push_back({0, 0.0, 0, bins_.size()});
      bins_.push_back({r, {points.begin(), points.end()}});
      return;
    }
    const std::size_t axis = depth % 2 == 0 ? 0 : 1;
    const double place = median(r, points, axis);
    const std::size_t half = points.size() / 2;
    split(r, axis, place, {points.first(half), points.subspan(half)}, {depth - 1, depth - 1});
  }

  /// Returns the median of the points, which are partitioned around it. With fewer than two points, returns the centre
  /// of the rectangle.
  static double median(const Rectangle& r, Points points, std::size_t axis) {
    if (points.size() < 2) return 0.5 * (r.low[axis] + r.high[axis]);
    const std::size_t half = points.size() / 2;
    const auto less = [axis](const auto& a, const auto& b) { return a[axis] < b[axis]; };
    std::nth_element(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(half), points.end(), less);
    return points[half][axis];
  }

  static std::array<Rectangle, 4> quarters(const Rectangle& r) {
    const double x = 0.5 * (r.low[0] + r.high[0]);
    const double a = 0.5 * (r.low[1] + r.high[1]);
    return {{{r.low, {x, a}}, {{x, r.low[1]}, {r.high[0], a}}, {{r.low[0], a}, {x, r.high[1]}}, {{x, a}, r.high}}};
  }

  template <typename Density>
  static double value_at(const Density& pdf, double x, double angle) {
    const double radius = std::sqrt(std::max(0.0, 1.0 - x * x));
    const Eigen::Vector3d d(x, radius * std::cos(angle), radius * std::sin(angle));
    return static_cast<double>(pdf(render::Vec3(d.cast<float>())));
  }

  /// Integrates with 3 x 3 points of Gauss-Legendre quadrature.
  template <typename Density>
  static double gauss(const Density& pdf, const Rectangle& r) {
    constexpr std::array<double, 3> kPlaces = {-0.7745966692414834, 0.0, 0.7745966692414834};
    constexpr std::array<double, 3> kWeights = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
    double sum = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double x = 0.5 * (r.low[0] + r.high[0] + (r.high[0] - r.low[0]) * kPlaces[i]);
      for (std::size_t j = 0; j < 3; ++j) {
        const double angle = 0.5 * (r.low[1] + r.high[1] + (r.high[1] - r.low[1]) * kPlaces[j]);
        sum += kWeights[i] * kWeights[j] * value_at(pdf, x, angle);
      }
    }
    return sum * area(r);
  }
  static double area(const Rectangle& r) { return (r.high[0] - r.low[0]) * (r.high[1] - r.low[1]); }

  template <typename Density>
  double refined(const Density& pdf, const Rectangle& r, double coarse, const std::vector<Probe>& probes,
                 int level) const {
    constexpr int kMaxLevels = 10;
    constexpr int kMaxPeakLevels = 16;
    const double tolerance = 1e-6 / static_cast<double>(bins_.size());
    std::array<double, 4> parts{};
    double sum = 0.0;
    const std::array<Rectangle, 4> cells = quarters(r);
    for (std::size_t i = 0; i < 4; ++i) sum += parts[i] = gauss(pdf, cells[i]);
    const double level_pdf = (2.0 * sum + tolerance) / area(r);
    const bool has_peak =
        std::any_of(probes.begin(), probes.end(), [&](const Probe& probe) { return probe.pdf > level_pdf; });
    if (level >= (has_peak ? kMaxPeakLevels : kMaxLevels)) return sum;
    if (!has_peak && std::abs(sum - coarse) < tolerance) return sum;
    sum = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
      std::vector<Probe> inside;
      for (const Probe& probe : probes) {
        const bool right = probe.at[0] >= cells[i].low[0] && probe.at[0] < cells[i].high[0];
        if (right && probe.at[1] >= cells[i].low[1] && probe.at[1] < cells[i].high[1]) inside.push_back(probe);
      }
      sum += refined(pdf, cells[i], parts[i], inside, level + 1);
    }
    return sum;
  }

  std::vector<Node> nodes_;
  std::vector<Bin> bins_;
  std::vector<double> counts_;  ///< Count of each bin; the last is that of lost samples.
  double total_ = 0.0;
};

struct SamplerCheck {
  ChiSquare chi_square;
  double integral = 0.0;  ///< Integral of the pdf over the sphere.
  double lost = 0.0;      ///< Fraction of the samples without a direction.
};

/// Tests sample(const Vec2& u, float choice) -> std::optional<Vec3> against pdf(const Vec3&). Draws `samples` / 4 more
/// samples to define the bins.
template <typename Sample, typename Density>
[[nodiscard]] SamplerCheck check_sampler(const Sample& sample, const Density& pdf, int samples = 1 << 15,
                                         unsigned seed = 1, int depth = 7) {
  std::mt19937 random(seed);
  const auto unit = [&random] { return static_cast<float>(random() >> 8) * 0x1p-24f; };
  const auto draw = [&]() -> std::optional<render::Vec3> {
    const float choice = unit();
    const float x = unit();
    return sample(render::Vec2(x, unit()), choice);
  };
  std::vector<render::Vec3> pilot;
  for (int i = 0; i < samples / 4; ++i) {
    if (const std::optional<render::Vec3> direction = draw()) pilot.push_back(*direction);
  }
  SphereHistogram histogram(pilot, depth);
  for (int i = 0; i < samples; ++i) {
    if (const std::optional<render::Vec3> direction = draw()) {
      histogram.add(*direction);
    } else {
      histogram.add_lost();
    }
  }
  SamplerCheck check;
  check.chi_square = histogram.compare(pdf, &check.integral);
  check.lost = histogram.lost();
  return check;
}

}  // namespace cyclorama
