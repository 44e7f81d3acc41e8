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
constexpr std::size_t kSoftwareMesh = 2;  ///< Index of the mesh that a display without a card draws.

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

/// Processor and wall time of runs of kDrawsPerRun drawings.
class Times {
 public:
  template <typename Draw>
  Status measure(bool counts, Draw draw) {
    const double cpu_before = cpu_seconds();
    const TimePoint before = clock_.now();
    for (int n = 0; n < kDrawsPerRun; ++n) TRY(draw(n));
    if (!counts) return Done{};
    cpu_ms_.push_back(1e3 * (cpu_seconds() - cpu_before) / kDrawsPerRun);
    wall_ms_.push_back(to_milliseconds(clock_.now() - before) / kDrawsPerRun);
    return Done{};
  }
  void write_to(WalkCost* cost) const {
    cost->cpu_ms = median(cpu_ms_);
    cost->wall_ms = median(wall_ms_);
  }

 private:
  SteadyClock clock_;
  std::vector<double> cpu_ms_;
  std::vector<double> wall_ms_;
};

}  // namespace

Result<WalkCosts> walk_costs(int width, int height, int rounds) {
  const Panorama wall{width, height, 2.6, 0.5, -0.5};
  TRY_ASSIGN(const std::unique_ptr<ShownWall> shown, ShownWall::make(wall, {}));
  display::DisplayFrame frame;
  frame.shape = wall;
  frame.picture = std::make_shared<const PlanarPicture>(width, height, true);
  const InverseDepthImage depth = pillared_room(width, height);
  WalkCosts costs{shown->renderer(), {{0}, {1}, {2}, {4}}, {2}, {2}};
  std::vector<display::DisplayFrame> frames;
  for (const WalkCost& cost : costs.each) {
    const int cell_px = kDepthCellPx * std::max(1, cost.mesh_cells);
    frame.mesh = std::make_shared<const display::ReprojectionMesh>(
        std::make_shared<const display::ReprojectionGrid>(Projection{wall, {}}, cell_px), depth);
    frames.push_back(frame);
  }
  std::vector<Times> moves(frames.size());
  Times taken, reusing;
  for (int round = -1; round < rounds; ++round) {  // The first warms up.
    for (std::size_t i = 0; i < frames.size(); ++i) {
      TRY(shown->take(frames[i], false));
      const bool is_moved = costs.each[i].mesh_cells > 0;
      TRY(moves[i].measure(round >= 0, [&](int n) {
        return shown->convert(is_moved ? Eigen::Vector3d(0.05 + 0.002 * n, 0.0, -0.03) : Eigen::Vector3d::Zero());
      }));
    }
    for (const bool reuses : {false, true}) {
      const auto draw = [&, next = frames[kSoftwareMesh]](int n) mutable -> Status {
        next.eye_m = {0.02 * n, 0.0, -0.05 * n};
        TRY(shown->take(next, reuses));
        return shown->finish();
      };
      TRY((reuses ? reusing : taken).measure(round >= 0, draw));
    }
  }
  for (std::size_t i = 0; i < frames.size(); ++i) moves[i].write_to(&costs.each[i]);
  taken.write_to(&costs.taken);
  reusing.write_to(&costs.reusing);
  return costs;
}

}  // namespace cyclorama
