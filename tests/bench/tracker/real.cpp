// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "common/image/image_file.h"
#include "tests/bench/tracker/pose_errors.h"
#include "tests/bench/tracker/tracker_bench.h"

namespace cyclorama {
namespace {

using Corners = std::array<Eigen::Vector2d, 4>;
struct Listed {
  int id;
  Corners corners;
};

std::vector<Listed> list_of(const std::filesystem::path& file) {
  std::vector<Listed> listed;
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);) {
    int id = 0;
    std::array<double, 8> c{};
    if (std::sscanf(line.c_str(), "%d, (%lf %lf), (%lf %lf), (%lf %lf), (%lf %lf)", &id, &c[0], &c[1], &c[2], &c[3],
                    &c[4], &c[5], &c[6], &c[7]) == 9) {
      listed.push_back({id, {Eigen::Vector2d(c[6], c[7]), {c[4], c[5]}, {c[2], c[3]}, {c[0], c[1]}}});
    }
  }
  return listed;
}

double distance_px(const std::vector<tags::TagDetection>& found, const Listed& listed) {
  double best = 1e9;
  for (const tags::TagDetection& tag : found) {
    double worst = tag.id == listed.id ? 0.0 : 1e9;
    for (std::size_t i = 0; i < 4; ++i) worst = std::max(worst, (tag.corners[i] - listed.corners[i]).norm());
    best = std::min(best, worst);
  }
  return best;
}

/// Deviation of the corners of printed tags from a true square seen by a pinhole camera, per coordinate: a pose uses
/// six of eight numbers, so two are left over. It is the joint effect of lens, paper and detector;
/// TrackingSettings::corner_floor_px is the part that the detector cannot estimate.
nlohmann::json corner_deviations(const std::filesystem::path& folder) {
  const Pinhole lens{640, 480, 338.56, 336.455, 230.487, 338.563 / 338.939};  // test_info.yaml
  std::vector<double> squares, excess;
  auto detector = tags::TagSearch::create({.decimate = 1.0, .tiles = false});
  for (const char* const name : {"01", "02", "03", "04", "05"}) {
    const auto photo = read_grey_image(folder / (std::string("test_image_multiple_") + name + ".png"), kPhotoLimitPx);
    if (!photo || !detector || photo->width() != lens.width_px) continue;
    const auto found = detector->search(*photo);
    if (!found) continue;
    for (const tags::TagDetection& tag : *found) {
      const auto poses = tracker::estimate_poses(tag.corners, 0.065, lens);
      if (!poses) continue;
      const double left = 4.0 * poses->best.reprojection_px * poses->best.reprojection_px;
      double claimed = 0.0;
      for (const Eigen::Matrix2d& covariance : tag.covariance) claimed += 0.25 * covariance.trace();
      squares.push_back(0.5 * left);
      excess.push_back(0.5 * left - 0.5 * claimed);
    }
  }
  if (squares.empty()) return nullptr;
  const auto mean = [](const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
  };
  std::vector<double> sorted = squares;
  std::sort(sorted.begin(), sorted.end());
  // For a chi-square with two degrees of freedom, divided by two, the median is ln 2.
  const double robust = std::sqrt(sorted[sorted.size() / 2] / 0.6931);
  const double floor = std::sqrt(std::max(0.0, mean(excess)));
  std::printf(
      "%zu printed tags: corners are %.3f px off a true square, per coordinate (by the median: %.3f px); beyond "
      "what the detector claims: %.3f px\n",
      squares.size(), std::sqrt(mean(squares)), robust, floor);
  return {
      {"tags", squares.size()}, {"deviation_px", std::sqrt(mean(squares))}, {"robust_px", robust}, {"floor_px", floor}};
}

struct Way {
  const char* name;
  double decimate;
  bool tiles;
  /// Uses the detector's own corners, from which the lists were made.
  bool own_corners;
};

}  // namespace

nlohmann::json measure_real() {
  const char* const shared = std::getenv("CYCLORAMA_SHARED");
  const std::filesystem::path folder =
      std::filesystem::path(shared != nullptr ? shared : "../shared") / "data/apriltag/swarmathon";
  nlohmann::json result = {{"listed", 0}, {"found", 0}};
  std::vector<std::pair<GreyImage, std::vector<Listed>>> photos;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    if (entry.path().extension() != ".txt") continue;
    auto photo = read_grey_image(std::filesystem::path(entry.path()).replace_extension(".jpg"), kPhotoLimitPx);
    if (photo) photos.emplace_back(*std::move(photo), list_of(entry.path()));
  }
  if (photos.empty()) {
    std::printf("no photos in %s\n", folder.c_str());
    return result;
  }
  std::printf(
      "%zu photos, each shown %d times: tags found in the first and in the last picture, corners against the "
      "lists, milliseconds per picture\n",
      photos.size(), 2 * tags::TagSearch::kJobs);
  for (const Way& way :
       {Way{"decimation 1", 1.0, false, true}, Way{"decimation 2", 2.0, false, true}, Way{"2, tiles", 2.0, true, true},
        Way{"1.5, tiles", 1.5, true, true}, Way{"1.5, tiles, refined", 1.5, true, false}}) {
    tags::DetectorSettings settings;
    settings.decimate = way.decimate;
    settings.tiles = way.tiles;
    settings.max_hamming = 2;
    settings.min_margin = 0.0;
    settings.refine_edges = !way.own_corners;
    settings.refine_corners = !way.own_corners;
    int listed = 0, first = 0, last = 0;
    double largest = 0.0;
    std::vector<double> ms;
    for (const auto& [photo, tags] : photos) {
      auto search = tags::TagSearch::create(settings);
      for (int i = 0; i < 2 * tags::TagSearch::kJobs; ++i) {
        const double began = thread_cpu_seconds();
        const auto found = search->search(photo);
        ms.push_back(1e3 * (thread_cpu_seconds() - began));
        if (i != 0 && i != 2 * tags::TagSearch::kJobs - 1) continue;
        for (const Listed& tag : tags) {
          const double distance = distance_px(*found, tag);
          if (distance > 2.0) continue;
          (i == 0 ? first : last) += 1;
          if (i != 0) largest = std::max(largest, distance);
        }
      }
      listed += static_cast<int>(tags.size());
    }
    std::sort(ms.begin(), ms.end());
    const double median = ms[ms.size() / 2];
    std::printf("%-20s listed %d, first %d, last %d, farthest corner %.3f px, median %.1f ms, p99 %.1f ms\n", way.name,
                listed, first, last, largest, median, ms[ms.size() * 99 / 100]);
    result["ways"].push_back({{"name", way.name},
                              {"found_first", first},
                              {"found", last},
                              {"max_corner_px", largest},
                              {"median_ms", median}});
    if (way.tiles && way.own_corners && way.decimate == tags::DetectorSettings().decimate) {
      result["listed"] = listed;
      result["found"] = last;
      result["max_corner_px"] = largest;
      result["median_ms"] = median;
    }
  }
  result["corner"] = corner_deviations(folder.parent_path() / "duckietown");
  return result;
}

nlohmann::json measure_speed(int pictures) {
  simulated::Simulation simulation;
  const simulated::SimulatedView view(simulation);
  nlohmann::json result;
  std::printf("The demo's hand, 640x480, one thread, search and pose, %d pictures\n", pictures);
  for (const bool tiles : {false, true}) {
    tags::DetectorSettings settings;
    settings.tiles = tiles;
    auto search = tags::TagSearch::create(settings);
    tracker::TrackingState state;
    std::vector<double> ms;
    int tracked = 0;
    for (int i = 0; i < pictures; ++i) {
      const double time_s = 28.0 * i / pictures;
      const GreyImage picture = view.picture(static_cast<std::uint64_t>(time_s * simulation.frames_per_second));
      const double began = thread_cpu_seconds();
      const auto found = search->search(picture);
      const tracker::TrackingResult r = tracker::track({}, state, *found, simulation.lens, after(time_s));
      ms.push_back(1e3 * (thread_cpu_seconds() - began));
      state = r.state;
      tracked += r.tag ? 1 : 0;
    }
    std::sort(ms.begin(), ms.end());
    const nlohmann::json one = {{"median_ms", ms[ms.size() / 2]},
                                {"p99_ms", ms[ms.size() * 99 / 100]},
                                {"tracked", tracked},
                                {"pictures", pictures}};
    std::printf("%-34s median %.2f ms, p99 %.2f ms, tracked %d\n",
                tiles ? "full resolution where a tag was" : "the whole picture, decimated",
                one["median_ms"].get<double>(), one["p99_ms"].get<double>(), tracked);
    if (tiles) {
      result.update(one);
    } else {
      result["decimated"] = one;
    }
  }
  return result;
}

}  // namespace cyclorama
