// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/walk/walk_cost.h"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/bench/walk/shown_wall.h"

namespace cyclorama {
namespace {

constexpr int kDrawsPerRun = 4;
constexpr int kPillars = 24;

/// A round room of 5 m with pillars between 1.5 and 4 m.
InverseDepthImage pillared_room(int width, int height) {
  const PixelRect cells = depth_cells({0, 0, width, height});
  InverseDepthImage depth(cells.width, cells.height, inverse_depth_of(5.0f));
  std::mt19937 random(5);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (int n = 0; n < kPillars; ++n) {
    const auto left = static_cast<int>(share(random) * cells.width);
    const auto right = std::min(cells.width, left + 2 + static_cast<int>(share(random) * cells.width / 40));
    const std::uint16_t near = inverse_depth_of(static_cast<float>(1.5 + 2.5 * share(random)));
    for (int y = static_cast<int>(share(random) * cells.height / 3); y < cells.height; ++y) {
      for (int x = left; x < right; ++x) *depth.at(x, y) = near;
    }
  }
  return depth;
}

double cpu_seconds() {
  rusage used{};
  ::getrusage(RUSAGE_SELF, &used);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

double median(std::vector<double> values) {
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}

}  // namespace

Result<WalkCosts> walk_costs(int width, int height, int rounds) {
  const Panorama wall{width, height, 2.6, 0.5, -0.5};
  TRY_ASSIGN(const std::unique_ptr<ShownWall> shown, ShownWall::make(wall));
  display::DisplayFrame frame;
  frame.shape = wall;
  frame.picture = std::make_shared<const PlanarPicture>(width, height, true);
  const InverseDepthImage depth = pillared_room(width, height);
  WalkCosts costs{shown->renderer(), {{0}, {1}, {2}, {4}}};
  std::vector<display::DisplayFrame> frames;
  for (const WalkCost& cost : costs.each) {
    const int cell_px = kDepthCellPx * std::max(1, cost.mesh_cells);
    frame.mesh = std::make_shared<const display::ReprojectionMesh>(
        std::make_shared<const display::ReprojectionGrid>(Projection{wall, {}}, cell_px), depth);
    frames.push_back(frame);
  }
  std::vector<std::vector<double>> cpu(frames.size());
  std::vector<std::vector<double>> wall_time(frames.size());
  const SteadyClock clock;
  for (int round = -1; round < rounds; ++round) {  // The first warms up.
    for (std::size_t i = 0; i < frames.size(); ++i) {
      TRY(shown->take(frames[i]));
      const bool moves = costs.each[i].mesh_cells > 0;
      const double cpu_before = cpu_seconds();
      const TimePoint before = clock.now();
      for (int n = 0; n < kDrawsPerRun; ++n) {
        TRY(shown->convert(moves ? Eigen::Vector3d(0.05 + 0.002 * n, 0.0, -0.03) : Eigen::Vector3d::Zero()));
      }
      if (round < 0) continue;
      cpu[i].push_back(1e3 * (cpu_seconds() - cpu_before) / kDrawsPerRun);
      wall_time[i].push_back(to_milliseconds(clock.now() - before) / kDrawsPerRun);
    }
  }
  for (std::size_t i = 0; i < frames.size(); ++i) {
    costs.each[i].cpu_ms = median(cpu[i]);
    costs.each[i].wall_ms = median(wall_time[i]);
  }
  return costs;
}

}  // namespace cyclorama
