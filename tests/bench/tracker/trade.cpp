// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cstdio>

#include "tests/bench/tracker/pose_errors.h"
#include "tests/bench/tracker/tracker_bench.h"

namespace cyclorama {
namespace {

/// Poses as measured by the tracker, before the filter, and the truth.
struct Measured {
  double time_s;
  tracker::T_CameraTag pose, truth;
};

std::vector<Measured> measured_along(const simulated::HandPath& path, double seconds) {
  simulated::Simulation simulation;
  simulation.lens = kBenchLens;
  simulation.path = path;
  simulation.noise_grey = 2.5;
  const simulated::SimulatedView view(simulation);
  auto search = tags::TagSearch::create({});
  tracker::TrackingState state;
  std::vector<Measured> measured;
  for (int i = 0; i < static_cast<int>(seconds * simulation.frames_per_second); ++i) {
    const double time_s = i / simulation.frames_per_second;
    const auto found = search->search(view.picture(static_cast<std::uint64_t>(i)));
    const tracker::TrackingResult result = tracker::track({}, state, *found, simulation.lens, after(time_s));
    state = result.state;
    if (!result.tag) continue;
    measured.push_back({time_s, result.tag->chosen.pose.T_camera_tag, path.at(time_s + 0.5 * simulation.exposure_s)});
  }
  return measured;
}

simulated::HandPath path_of(std::vector<simulated::KeyPose> keys, std::optional<double> loop_s) {
  return *simulated::HandPath::make(std::move(keys), loop_s);
}

struct FilterFigures {
  double lag_ms = 0.0;  ///< Lag that best explains the error while moving, by least squares of error on speed.
  double jitter = 0.0;  ///< Standard deviation at rest.
};

/// Lag and jitter of one quantity: yaw in degrees, or x in millimetres.
template <typename Filter, typename Truth>
FilterFigures figures_of(const std::vector<Measured>& moving, const std::vector<Measured>& resting, const Filter& run,
                         const Truth& truth) {
  FilterFigures figures;
  const std::vector<double> moved = run(moving);
  double by_speed = 0.0, speeds = 0.0;
  for (std::size_t i = 5; i + 1 < moving.size(); ++i) {
    const double speed = (truth(moving[i + 1]) - truth(moving[i - 1])) / (moving[i + 1].time_s - moving[i - 1].time_s);
    by_speed += (moved[i] - truth(moving[i])) * speed;
    speeds += speed * speed;
  }
  figures.lag_ms = -1e3 * by_speed / speeds;
  const std::vector<double> rested = run(resting);
  double sum = 0.0, squares = 0.0;
  const std::size_t from = resting.size() / 3;
  for (std::size_t i = from; i < rested.size(); ++i) sum += rested[i];
  const double mean = sum / static_cast<double>(rested.size() - from);
  for (std::size_t i = from; i < rested.size(); ++i) squares += (rested[i] - mean) * (rested[i] - mean);
  figures.jitter = std::sqrt(squares / static_cast<double>(rested.size() - from));
  return figures;
}

double yaw_of(const Eigen::Quaterniond& rotation) { return tracker::yaw_rad({rotation, {0, 0, 1}}) / kDegree; }

/// `far`: also at rest, but twice as far away, where noise is larger.
nlohmann::json filter_curve(const std::vector<Measured>& moving, const std::vector<Measured>& resting,
                            const std::vector<Measured>& far) {
  nlohmann::json points;
  std::printf("One-Euro: cut-off at rest (Hz), Hz per rad/s or per m/s; lag while moving, jitter at rest\n");
  std::printf("   Hz   slope |  yaw: lag ms  jitter at 1 m, 2 m, deg |  slope | x: lag ms  jitter mm\n");
  for (const double cutoff : {0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 1000.0}) {
    for (const double slope : {0.0, 5.0, 20.0, 60.0, 200.0}) {
      if (cutoff == 1000.0 && slope > 0.0) continue;
      const tracker::OneEuroSettings turning{cutoff, slope, 1.0};
      const tracker::OneEuroSettings sliding{cutoff, 2.0 * slope, 1.0};
      const auto turn = [&](const std::vector<Measured>& run) {
        std::vector<double> out;
        std::optional<tracker::FilteredRotation> state;
        for (const Measured& m : run) {
          state = tracker::filter(turning, state, m.pose.rotation(), after(m.time_s));
          out.push_back(yaw_of(state->value));
        }
        return out;
      };
      const auto true_yaw = [](const Measured& m) { return yaw_of(m.truth.rotation()); };
      const FilterFigures yaw = figures_of(moving, resting, turn, true_yaw);
      const double far_jitter = figures_of(moving, far, turn, true_yaw).jitter;
      const FilterFigures x = figures_of(
          moving, resting,
          [&](const std::vector<Measured>& run) {
            std::vector<double> out;
            std::optional<tracker::FilteredPosition> state;
            for (const Measured& m : run) {
              state = tracker::filter(sliding, state, m.pose.translation(), after(m.time_s));
              out.push_back(1e3 * state->value.x());
            }
            return out;
          },
          [](const Measured& m) { return 1e3 * m.truth.translation().x(); });
      std::printf("%6.1f  %5.0f |  %8.1f     %7.4f  %7.4f   | %5.0f  | %7.1f   %7.4f\n", cutoff, slope, yaw.lag_ms,
                  yaw.jitter, far_jitter, 2.0 * slope, x.lag_ms, x.jitter);
      points.push_back({{"knob", "filter"},
                        {"cutoff_hz", cutoff},
                        {"hz_per_rad_s", slope},
                        {"hz_per_m_s", 2.0 * slope},
                        {"yaw_lag_ms", yaw.lag_ms},
                        {"yaw_jitter_deg", yaw.jitter},
                        {"yaw_jitter_2m_deg", far_jitter},
                        {"x_lag_ms", x.lag_ms},
                        {"x_jitter_mm", x.jitter}});
    }
  }
  return points;
}

nlohmann::json search_curve(const char* knob, double value, const Wand& wand, const tags::DetectorSettings& settings,
                            int scenes, double distance_m = 2.0) {
  tracker::TrackingSettings tracking;
  tracking.patterns.wands = {wand};
  const HandStudio studio(wand);
  PoseRun run;
  for (int i = 0; i < scenes; ++i) {
    auto search = tags::TagSearch::create(settings);
    const auto number = static_cast<std::uint64_t>(i);
    add_scene(studio, HandScene::sampled(number, distance_m, 60.0), number, tracking, &*search, &run);
  }
  const PoseFigures f = figures_of(run);
  std::sort(run.seconds.begin(), run.seconds.end());
  const double median_ms = 1e3 * run.seconds[run.seconds.size() / 2];
  std::printf(
      "%-18s %5.1f at %.1f m | found %5.1f %%  yaw sd %5.3f deg  p99 %5.2f deg  flips %3d  x sd %5.3f mm  median %5.2f "
      "ms\n",
      knob, value, distance_m, 100.0 * (f.frames - f.lost) / f.frames, f.yaw_sd_deg, f.yaw_p99_deg, f.flips, f.x_sd_mm,
      median_ms);
  std::fflush(stdout);
  return {{"knob", knob},
          {"value", value},
          {"distance_m", distance_m},
          {"flips", f.flips},
          {"found_share", 1.0 - 1.0 * f.lost / f.frames},
          {"yaw_sd_deg", f.yaw_sd_deg},
          {"yaw_p99_deg", f.yaw_p99_deg},
          {"x_sd_mm", f.x_sd_mm},
          {"pictures", f.frames},
          {"median_ms", median_ms}};
}

}  // namespace

nlohmann::json measure_trade(bool quick, const std::string& only, int wanted_scenes) {
  const auto asked = [&](const char* knob) { return only.empty() || only == knob; };
  const simulated::HandPath sway =
      path_of({{0.0, {0.15, 0.03, 1.0}, 0.5, 0.14, 0.02}, {0.8, {-0.15, 0.03, 1.0}, -0.5, 0.14, -0.02}}, 1.6);
  const simulated::HandPath rest = path_of({{0.0, {0.02, 0.03, 1.0}, 0.2, 0.14, 0.02}}, std::nullopt);
  const simulated::HandPath far = path_of({{0.0, {0.02, 0.03, 2.0}, 0.2, 0.14, 0.02}}, std::nullopt);
  const double seconds = quick ? 6.0 : 40.0;
  nlohmann::json points = nlohmann::json::array();
  if (asked("filter"))
    points = filter_curve(measured_along(sway, seconds), measured_along(rest, seconds), measured_along(far, seconds));

  const int scenes = wanted_scenes > 0 ? wanted_scenes : quick ? 10 : 150;
  std::printf("|yaw| to 60 deg, as tag-pose\n");
  for (const bool tiles : {false, true}) {
    for (const double decimate : {1.0, 1.5, 2.0, 3.0, 4.0}) {
      if (!asked("decimation") || (tiles && decimate == 1.0)) continue;
      tags::DetectorSettings settings;
      settings.decimate = decimate;
      settings.tiles = tiles;
      points.push_back(
          search_curve(tiles ? "decimation, tiles" : "decimation", decimate, standard_wand(0), settings, scenes));
    }
  }
  for (const double scale : {0.7, 1.0, 1.2, 1.4142}) {
    if (!asked("size")) break;
    const FoldedCard card = FoldedCard().scaled(scale);
    for (const double distance_m : {2.0, 2.5}) {
      points.push_back(
          search_curve("tag size, mm", 1e3 * card.tag_size_m, standard_wand(0, card), {}, scenes, distance_m));
    }
  }
  for (const double fold_deg : {0.01, 15.0, 25.0, 35.0, 45.0, 55.0}) {
    if (!asked("fold")) break;
    FoldedCard card;
    card.fold_rad = fold_deg * kDegree;
    for (const double distance_m : {2.0, 2.5})
      points.push_back(search_curve("fold, deg", fold_deg, standard_wand(0, card), {}, scenes, distance_m));
  }
  return {{"points", points}};
}

}  // namespace cyclorama
