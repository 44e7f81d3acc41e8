// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/balance/balancer.h"

#include <algorithm>
#include <cmath>

#include "renderfarm/balance/split_tree.h"

namespace cyclorama {
namespace {

/// New blocks must promise this much more efficiency than the old ones keep: below it, measured times only tremble.
constexpr double kWorthMoving = 0.01;

double predicted_efficiency(const CostField& cost, PictureSize size, std::span<const PixelRect> blocks,
                            std::span<const double> speeds) {
  std::vector<double> loads;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    loads.push_back(blocks[i].empty() ? 0.0 : cost.cost_of(fractions_of(blocks[i], size)) / speeds[i]);
  }
  return balance_efficiency(loads);
}

/// A speed that is no number, or none, would make cuts that are none.
std::vector<double> usable(std::span<const double> speeds) {
  std::vector<double> out(speeds.begin(), speeds.end());
  for (double& speed : out) speed = std::isfinite(speed) ? std::clamp(speed, 1e-6, 1e12) : 1.0;
  return out;
}

std::vector<PlannedBlock> one_each(std::span<const PixelRect> rects) {
  std::vector<PlannedBlock> out;
  for (std::size_t i = 0; i < rects.size(); ++i) {
    if (!rects[i].empty()) out.push_back({i, rects[i]});
  }
  return out;
}

class EqualBalancer final : public Balancer {
 public:
  std::vector<PlannedBlock> split(const SplitRequest& request) override {
    return one_each(SplitTree(request.speeds.size()).split(request.size, CostField(), usable(request.speeds)));
  }
  void learn(const MeasuredFrame&) override {}
};

class PbtBalancer final : public Balancer {
 public:
  std::vector<PlannedBlock> split(const SplitRequest& request) override {
    const std::vector<double> speeds = usable(request.speeds);
    if (speeds != speeds_ || !(request.size == size_)) {
      // Nodes came or went, or the picture changed its shape: another tree, over the costs that are known.
      if (speeds.size() != speeds_.size()) tree_ = SplitTree(speeds.size());
      speeds_ = speeds;
      size_ = request.size;
      blocks_.clear();
    }
    azimuth_span_rad_ = request.azimuth_span_rad;
    const CostField expected = cost_.shifted_left((request.heading_rad - heading_rad_) / request.azimuth_span_rad);
    std::vector<PixelRect> moved = tree_.split(size_, expected, speeds_);
    if (blocks_.empty() || predicted_efficiency(expected, size_, moved, speeds_) >
                               predicted_efficiency(expected, size_, blocks_, speeds_) + kWorthMoving) {
      blocks_ = std::move(moved);
    }
    return one_each(blocks_);
  }

  void learn(const MeasuredFrame& frame) override {
    cost_ = cost_.shifted_left((frame.heading_rad - heading_rad_) / azimuth_span_rad_);
    cost_.learn(frame.size, frame.blocks);
    heading_rad_ = frame.heading_rad;
  }

 private:
  CostField cost_;
  double heading_rad_ = 0.0;  ///< Where the picture looked whose costs are known.
  double azimuth_span_rad_ = 1.0;
  SplitTree tree_{0};
  PictureSize size_;
  std::vector<double> speeds_;
  std::vector<PixelRect> blocks_;  ///< What the last picture was split into.
};

}  // namespace

std::optional<BalanceStrategy> balance_strategy_of(std::string_view name) {
  if (name == "equal") return BalanceStrategy::kEqual;
  if (name == "pbt") return BalanceStrategy::kPbt;
  return std::nullopt;
}

std::unique_ptr<Balancer> make_balancer(BalanceStrategy strategy) {
  if (strategy == BalanceStrategy::kEqual) return std::make_unique<EqualBalancer>();
  return std::make_unique<PbtBalancer>();
}

double balance_efficiency(std::span<const double> loads) {
  double sum = 0.0;
  double largest = 0.0;
  for (const double load : loads) {
    sum += load;
    largest = std::max(largest, load);
  }
  return largest > 0.0 ? sum / (static_cast<double>(loads.size()) * largest) : 1.0;
}

}  // namespace cyclorama
