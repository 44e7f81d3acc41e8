// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cstdio>
#include <thread>

#include "tests/bench/tracker/pose_errors.h"
#include "tests/bench/tracker/tracker_bench.h"

namespace cyclorama {
namespace {

constexpr std::array kDistancesM{0.6, 1.0, 1.5, 2.0, 2.5};
constexpr double kMostYawDeg = 60.0;

PoseRun run_at(const HandStudio& studio, double distance_m, std::uint64_t first, std::uint64_t count, int threads) {
  std::vector<PoseRun> runs(static_cast<std::size_t>(threads));
  {
    std::vector<std::jthread> workers;
    for (int t = 0; t < threads; ++t) {
      workers.emplace_back([&, t] {
        for (auto i = static_cast<std::uint64_t>(t); i < count; i += static_cast<std::uint64_t>(threads)) {
          auto search = TagSearch::create({});
          add_scene(studio, HandScene::sampled(first + i, distance_m, kMostYawDeg), first + i, {}, &*search,
                    &runs[static_cast<std::size_t>(t)]);
        }
      });
    }
  }
  for (std::size_t t = 1; t < runs.size(); ++t) {
    runs[0].errors.insert(runs[0].errors.end(), runs[t].errors.begin(), runs[t].errors.end());
    runs[0].pictures += runs[t].pictures;
  }
  return std::move(runs[0]);
}

}  // namespace

nlohmann::json measure_pose(int frames, int threads) {
  const HandStudio studio;
  nlohmann::json result;
  std::printf(
      "Standard wand, 640x480, f = 600 px, |yaw| to %.0f deg, unfiltered; blur, noise, dim light, a finger on a "
      "tag (1 in 4), a second wand (1 in 4)\n",
      kMostYawDeg);
  std::printf("distance   frames   lost  yaw sd  yaw bias   p99   flips   x sd     error/claimed\n");
  const auto scenes = static_cast<std::uint64_t>(frames / (kPicturesOfScene * static_cast<int>(kDistancesM.size())));
  std::uint64_t first = 0;
  for (const double distance : kDistancesM) {
    const PoseFigures f = figures_of(run_at(studio, distance, first, scenes, threads));
    first += scenes;
    std::printf("%5.1f m  %8d %6d  %5.3f    %5.3f    %5.2f  %4d  %6.3f mm   %5.2f\n", distance, f.frames, f.lost,
                f.yaw_sd_deg, f.yaw_bias_deg, f.yaw_p99_deg, f.flips, f.x_sd_mm, f.claimed);
    std::fflush(stdout);
    result[fmt::format("{:.1f}", distance)] = {
        {"yaw_sd_deg", f.yaw_sd_deg},   {"yaw_bias_deg", f.yaw_bias_deg}, {"flips", f.flips},
        {"frames", f.frames},           {"x_sd_mm", f.x_sd_mm},           {"lost", f.lost},
        {"yaw_p99_deg", f.yaw_p99_deg}, {"error_per_claimed", f.claimed}};
  }
  return result;
}

}  // namespace cyclorama
