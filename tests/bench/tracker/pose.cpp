// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <thread>

#include "tests/bench/tracker/pose_errors.h"
#include "tests/bench/tracker/tracker_bench.h"

namespace cyclorama {
namespace {

constexpr std::array kDistancesM{0.6, 1.0, 1.5, 2.0, 2.5};
constexpr double kMaxYawDeg = 60.0;

/// Results of ten pictures of one scene, at each distance.
using Scenes = std::array<PoseRun, kDistancesM.size()>;

void add(const PoseRun& from, PoseRun* to) {
  to->errors.insert(to->errors.end(), from.errors.begin(), from.errors.end());
  to->pictures += from.pictures;
  to->company += from.company;
}

/// Runs scene `index` of `scenes` at each distance; every distance has scenes of its own.
Scenes run_scene(const HandStudio& studio, std::uint64_t index, std::uint64_t scenes) {
  Scenes runs;
  for (std::size_t d = 0; d < runs.size(); ++d) {
    const std::uint64_t number = d * scenes + index;
    auto search = tags::TagSearch::create({});
    add_scene(studio, HandScene::sampled(number, kDistancesM[d], kMaxYawDeg), number, {}, &*search, &runs[d]);
  }
  return runs;
}

/// Results of earlier runs: a line "scene INDEX", then for each distance "PICTURES COMPANY ERRORS" and a line per
/// error.
class KeptScenes {
 public:
  explicit KeptScenes(std::string path) : path_(std::move(path)) {}

  /// Adds the stored scenes to `*ret` and returns their number. An incomplete last scene is ignored.
  std::uint64_t read(Scenes* ret) {
    std::ifstream file(path_);
    std::string word;
    std::uint64_t index = 0, done = 0;
    while (file >> word >> index && word == "scene" && index == done) {
      Scenes scene;
      for (PoseRun& run : scene) {
        std::size_t errors = 0;
        file >> run.pictures >> run.company >> errors;
        for (std::size_t i = 0; i < errors && file; ++i) {
          PoseError e{};
          file >> e.true_yaw_deg >> e.yaw_deg >> e.x_mm >> e.yaw_in_deviations >> e.tags;
          run.errors.push_back(e);
        }
      }
      if (!file || !(file >> word) || word != "end") break;
      for (std::size_t d = 0; d < scene.size(); ++d) add(scene[d], &(*ret)[d]);
      ++done;
      whole_ = file.tellg();
    }
    return done;
  }
  void write(std::uint64_t index, const Scenes& scene) {
    if (path_.empty()) return;
    if (!file_.is_open()) {
      if (std::filesystem::exists(path_)) std::filesystem::resize_file(path_, static_cast<std::uintmax_t>(whole_));
      file_.open(path_, std::ios::app);
    }
    std::string text = fmt::format("scene {}\n", index);
    for (const PoseRun& run : scene) {
      text += fmt::format("{} {} {}\n", run.pictures, run.company, run.errors.size());
      for (const PoseError& e : run.errors)
        text += fmt::format("{:.6g} {:.6g} {:.6g} {:.6g} {}\n", e.true_yaw_deg, e.yaw_deg, e.x_mm, e.yaw_in_deviations,
                            e.tags);
    }
    file_ << text << "end\n" << std::flush;
  }

 private:
  std::string path_;
  std::ofstream file_;
  std::streamoff whole_ = 0;  ///< Size of the complete scenes in bytes.
};

/// Prints the yaw's errors by distance and true yaw, for people.
void print_by_yaw(const Scenes& runs) {
  std::printf("\nyaw sd (deg) by true yaw:   0-15    15-30   30-45   45-60\n");
  for (std::size_t d = 0; d < runs.size(); ++d) {
    std::printf("%5.1f m                  ", kDistancesM[d]);
    for (double from = 0.0; from < kMaxYawDeg; from += 15.0) {
      PoseRun part;
      for (const PoseError& e : runs[d].errors) {
        if (std::abs(e.true_yaw_deg) >= from && std::abs(e.true_yaw_deg) < from + 15.0) part.errors.push_back(e);
      }
      std::printf("  %6.3f", figures_of(part).yaw_sd_deg);
    }
    std::printf("\n");
  }
}

}  // namespace

nlohmann::json measure_pose(int frames, int threads, const std::string& keep, double seconds) {
  const HandStudio studio;
  nlohmann::json result;
  std::printf(
      "Standard wand, 640x480, f = 600 px, |yaw| to %.0f deg, unfiltered; blur, noise, dim light, a finger on a "
      "tag (1 in 4), a second wand (1 in 4)\n",
      kMaxYawDeg);
  std::printf("distance   frames   lost  other's  yaw sd  yaw bias   p99   flips   x sd     error/claimed\n");
  const auto scenes = static_cast<std::uint64_t>(frames / (kPicturesOfScene * static_cast<int>(kDistancesM.size())));
  KeptScenes kept(keep);
  Scenes runs;
  std::uint64_t next = kept.read(&runs);
  const TimePoint until =
      SteadyClock().now() + std::chrono::duration_cast<Duration>(std::chrono::duration<double>(std::min(seconds, 1e8)));
  while (next < scenes && SteadyClock().now() < until) {
    std::vector<Scenes> together(std::min<std::uint64_t>(static_cast<std::uint64_t>(threads), scenes - next));
    {
      std::vector<std::jthread> workers;
      for (std::size_t t = 0; t < together.size(); ++t)
        workers.emplace_back([&, t] { together[t] = run_scene(studio, next + t, scenes); });
    }
    for (const Scenes& scene : together) {
      kept.write(next++, scene);
      for (std::size_t d = 0; d < runs.size(); ++d) add(scene[d], &runs[d]);
    }
  }
  for (std::size_t d = 0; d < runs.size(); ++d) {
    const double distance = kDistancesM[d];
    const PoseFigures f = figures_of(runs[d]);
    std::printf("%5.1f m  %8d %6d  %7d  %5.3f    %5.3f    %5.2f  %4d  %6.3f mm   %5.2f\n", distance, f.frames, f.lost,
                f.company, f.yaw_sd_deg, f.yaw_bias_deg, f.yaw_p99_deg, f.flips, f.x_sd_mm, f.claimed);
    std::fflush(stdout);
    result[fmt::format("{:.1f}", distance)] = {
        {"yaw_sd_deg", f.yaw_sd_deg}, {"yaw_bias_deg", f.yaw_bias_deg}, {"flips", f.flips},
        {"frames", f.frames},         {"x_sd_mm", f.x_sd_mm},           {"lost", f.lost},
        {"other_wand", f.company},    {"yaw_p99_deg", f.yaw_p99_deg},   {"error_per_claimed", f.claimed}};
  }
  print_by_yaw(runs);
  return result;
}

}  // namespace cyclorama
