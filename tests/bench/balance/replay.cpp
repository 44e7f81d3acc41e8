// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/balance/replay.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "common/base/cpu_time.h"
#include "renderfarm/balance/tiles.h"

namespace cyclorama {
namespace {

balance::SplitRequest request_for(const balance::RecordedFrame& frame, const SimulatedFarm& farm) {
  return {.size = frame.work.size(),
          .speeds = farm.speeds,
          .heading_rad = frame.heading_rad,
          .azimuth_span_rad = frame.azimuth_span_rad,
          .block_overhead_seconds = farm.block_overhead_seconds,
          .node_overhead_seconds = farm.node_overhead_seconds,
          .eye_m = frame.eye_m,
          .effort = frame.effort};
}

balance::MeasuredFrame measured(const balance::RecordedFrame& frame, std::span<const balance::MeasuredBlock> blocks) {
  return {frame.work.size(), blocks, frame.heading_rad, frame.eye_m, frame.effort};
}

/// Returns the frame as one block of one node.
balance::MeasuredBlock whole(const balance::RecordedFrame& frame) {
  const balance::PictureSize size = frame.work.size();
  const auto cells = frame.work.cells();
  return {{0, 0, size.width, size.height}, frame.work.total(), {cells.begin(), cells.end()}, 1.0};
}

void add_noise(std::vector<balance::MeasuredBlock>* blocks, double noise, std::mt19937* random) {
  std::normal_distribution<double> factor(1.0, noise);
  for (balance::MeasuredBlock& block : *blocks) {
    block.cpu_seconds = 0.0;
    for (float& cell : block.cell_cpu_seconds) {
      cell = static_cast<float>(cell * std::max(0.0, factor(*random)));
      block.cpu_seconds += cell;
    }
  }
}

double relative_bytes(std::span<const balance::PlannedBlock> plan, balance::PictureSize size) {
  double sum = 0.0;
  for (const balance::PlannedBlock& block : plan) {
    for (const PixelRect& tile : balance::tiles_of(block.rect))
      sum += static_cast<double>(tile.area()) * relative_jpeg_bytes(tile);
  }
  return sum / (double(size.width) * size.height);
}

}  // namespace

double relative_jpeg_bytes(const PixelRect& tile) {
  // Log-log interpolation of the four measured points, over the side of a square with the same ratio of perimeter to
  // area.
  constexpr std::array<std::array<double, 2>, 4> kMeasured{{{32, 2.0}, {64, 0.5}, {128, 0.13}, {256, 0.04}}};
  const double side = 2.0 * tile.width * tile.height / (tile.width + tile.height);
  std::size_t i = 1;
  while (i + 1 < kMeasured.size() && side > kMeasured[i][0]) ++i;
  const auto& [x0, y0] = kMeasured[i - 1];
  const auto& [x1, y1] = kMeasured[i];
  return 1.0 + y0 * std::pow(y1 / y0, std::log(side / x0) / std::log(x1 / x0));
}

std::vector<ReplayedFrame> replay(std::span<const balance::RecordedFrame> frames, const ReplayOptions& options,
                                  const std::function<std::unique_ptr<balance::Balancer>()>& make) {
  std::vector<ReplayedFrame> out;
  std::mt19937 random(options.seed);
  std::unique_ptr<balance::Balancer> balancer = make();
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const balance::RecordedFrame& frame = frames[i];
    if (options.oracle) {
      const balance::MeasuredBlock all = whole(frame);
      balancer = make();
      balancer->learn(measured(frame, {&all, 1}));
    }
    const double begun = thread_cpu_seconds();
    const std::vector<balance::PlannedBlock> plan = balancer->split(request_for(frame, options.farm));
    const double plan_seconds = thread_cpu_seconds() - begun;
    SimulatedFrame simulated = simulate(options.farm, frame.work, plan);
    if (i > 0) {
      std::set<std::size_t> nodes;
      for (const balance::PlannedBlock& block : plan) nodes.insert(block.node);
      out.push_back({simulated.seconds, simulated.efficiency(options.farm.speeds), plan_seconds, plan.size(),
                     nodes.size(), simulated.steals, double(frame.work.size().width) * frame.work.size().height,
                     relative_bytes(plan, frame.work.size())});
    }
    if (options.timer_noise > 0.0) add_noise(&simulated.measured, options.timer_noise, &random);
    balancer->learn(measured(frame, simulated.measured));
  }
  return out;
}

}  // namespace cyclorama
