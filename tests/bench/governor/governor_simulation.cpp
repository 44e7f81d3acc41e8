// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/governor/governor_simulation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>
#include <random>

namespace cyclorama {
namespace {

constexpr double kSegmentS = 20.0;
constexpr double kStayS = 1.0;
constexpr double kSettleS = 2.0;
constexpr double kRegions[] = {1.0, 3.0, 1.0};
constexpr double kCheapRegion = 1.0 / 3.0;  ///< Cost of the first region, relative to the front's.
constexpr double kRaysNoise = 0.04;
constexpr double kFixedNoise = 0.1;
constexpr double kHungPart = 0.005;
constexpr double kHungFactor = 3.0;
constexpr double kMinExponent = 0.85;
constexpr double kMaxExponent = 1.1;
/// Costs rise and fall by this part while the visitor walks, in so many seconds.
constexpr double kSway = 0.05;
constexpr double kSwayS = 4.0;
/// Balance and contention: wall time of the rays over the busiest node's thread time.
constexpr double kContention = 1.15;
constexpr std::size_t kFramesInFlight = 2;
constexpr double kMinUsed = 0.8;
constexpr double kMinSettled = 0.7;
/// A picture of 320x160 on two cores. Larger farms have more pixels, but fewer for each core: 14.9 million with 4096.
constexpr double kMegapixelsOfTwoCores = 0.0512;
constexpr double kPixelsPerCores = 0.75;

class Farm {
 public:
  Farm(const GovernorCase& simulated, double exponent)
      : case_(simulated),
        exponent_(exponent),
        megapixels_(kMegapixelsOfTwoCores * std::pow(0.5 * simulated.cores, kPixelsPerCores)) {}

  [[nodiscard]] double megapixels() const { return megapixels_; }
  [[nodiscard]] double fixed_ms() const { return case_.fixed_part * case_.budget_ms; }
  /// Returns the busiest node's thread time. Costs are in microseconds per pixel, so cost times megapixels is seconds.
  [[nodiscard]] double rays_ms(double cost, double region) const {
    return 1e3 * kCheapRegion * region * std::pow(cost, exponent_) * megapixels_ / case_.cores;
  }
  [[nodiscard]] double expected_ms(double cost, double region) const {
    return fixed_ms() + kContention * rays_ms(cost, region);
  }

 private:
  const GovernorCase case_;
  const double exponent_;
  const double megapixels_;
};

/// Collects what happens in one region.
class Segment {
 public:
  Segment(const Farm& farm, const governor::ParetoFront& front, double budget_ms, double region)
      : budget_ms_(budget_ms) {
    min_ms_ = farm.expected_ms(front[0].cost, region);
    max_ms_ = farm.expected_ms(front.best().cost, region);
    out_.is_feasible = min_ms_ < kMinUsed * budget_ms && max_ms_ > kMinUsed * budget_ms;
  }
  /// `expected` is the frame's time without its noise.
  void add(double since_s, const governor::ParetoPoint& point, double expected, double ms) {
    if (!is_settled_ && !is_in_band(expected)) out_.settled_s = since_s + 1e-3 * ms;
    is_settled_ = is_settled_ || since_s - out_.settled_s >= kStayS;
    if (since_s >= kSettleS) {
      if (count_ > 0 && last_.quality != point.quality) ++out_.changes;
      ++count_;
      out_.min_scale = std::min(out_.min_scale, point.quality.scale);
      parts_.push_back(ms / budget_ms_);
    }
    last_ = point;
  }
  [[nodiscard]] GovernorSegment done() {
    if (parts_.empty()) return out_;
    for (const double part : parts_) out_.used += part / static_cast<double>(parts_.size());
    const auto p95 = parts_.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(parts_.size()));
    std::ranges::nth_element(parts_, p95);
    out_.p95 = *p95;
    return out_;
  }

 private:
  [[nodiscard]] bool is_in_band(double expected) const {
    constexpr double kTolerance = 1.0 + kSway;
    const double low = std::min(kMinSettled * budget_ms_, max_ms_ / kTolerance);
    const double high = std::max(budget_ms_, min_ms_ * kTolerance);
    return expected >= low && expected <= high;
  }

  const double budget_ms_;
  double min_ms_ = 0.0;
  double max_ms_ = 0.0;
  GovernorSegment out_;
  governor::ParetoPoint last_;
  int count_ = 0;
  bool is_settled_ = false;
  std::vector<double> parts_;
};

}  // namespace

std::string GovernorCase::name() const {
  return fmt::format("{} cores, {} ms, {:.0f} % fixed, {} thread times, seed {}", cores, budget_ms, 100 * fixed_part,
                     has_rays ? "with" : "without", seed);
}

GovernorOutcome simulate(const governor::ParetoFront& front, const GovernorCase& simulated) {
  GovernorOutcome outcome{simulated, {}};
  governor::Governor governor(front, simulated.budget_ms);
  std::seed_seq seed{static_cast<unsigned>(simulated.cores), static_cast<unsigned>(simulated.budget_ms),
                     static_cast<unsigned>(100 * simulated.fixed_part), simulated.has_rays ? 1U : 0U, simulated.seed};
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  const auto noisy = [&](double value, double noise) { return value * std::max(0.1, 1.0 + noise * normal(random)); };
  const Farm farm(simulated, std::lerp(kMinExponent, kMaxExponent, uniform(random)));
  std::deque<governor::MeasuredFrame> in_flight;
  bool is_hung = false;
  for (const double region : kRegions) {
    Segment segment(farm, front, simulated.budget_ms, region);
    for (double time_s = 0.0; time_s < kSegmentS;) {
      const governor::ParetoPoint point = governor.choose(farm.megapixels());
      const double sway = 1.0 + kSway * std::sin(2.0 * std::numbers::pi * time_s / kSwayS);
      const double rays = noisy(farm.rays_ms(point.cost, sway * region), kRaysNoise);
      double ms = noisy(farm.fixed_ms(), kFixedNoise) + kContention * rays;
      is_hung = !is_hung && uniform(random) < kHungPart;
      if (is_hung) ms *= kHungFactor;
      segment.add(time_s, point, farm.expected_ms(point.cost, sway * region), ms);
      time_s += 1e-3 * ms;
      in_flight.push_back({point.cost * farm.megapixels(), ms, simulated.has_rays ? rays : 0.0});
      if (in_flight.size() < kFramesInFlight) continue;
      governor.measured(in_flight.front());
      in_flight.pop_front();
    }
    outcome.segments.push_back(segment.done());
  }
  return outcome;
}

std::vector<GovernorCase> governor_cases(int seeds) {
  std::vector<GovernorCase> cases;
  for (const int cores : {2, 8, 64, 512, 4096}) {
    for (const double budget_ms : {33.0, 50.0, 100.0}) {
      for (const double fixed_part : {0.0, 0.1, 0.2, 0.3, 0.4}) {
        for (const bool has_rays : {true, false}) {
          for (int seed = 1; seed <= seeds; ++seed) {
            cases.push_back({cores, budget_ms, fixed_part, has_rays, static_cast<unsigned>(seed)});
          }
        }
      }
    }
  }
  return cases;
}

GovernorFigures figures_of(const std::vector<GovernorOutcome>& outcomes) {
  GovernorFigures figures;
  figures.cases = static_cast<int>(outcomes.size());
  for (const GovernorOutcome& outcome : outcomes) {
    for (const GovernorSegment& segment : outcome.segments) {
      figures.settled_s_max = std::max(figures.settled_s_max, segment.settled_s);
      figures.changes_per_s_max = std::max(figures.changes_per_s_max, segment.changes / (kSegmentS - kSettleS));
      if (segment.settled_s >= kSegmentS - kSettleS) ++figures.stuck;
      if (!segment.is_feasible) continue;
      figures.used_min = std::min(figures.used_min, segment.used);
      if (segment.p95 > 1.0) ++figures.over_p95;
    }
  }
  return figures;
}

}  // namespace cyclorama
