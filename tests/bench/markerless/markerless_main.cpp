// SPDX-License-Identifier: Apache-2.0
// Steering without a pattern, on rendered visitors with known truth: markerless_bench [--quick] [--json FILE]. Every
// picture is given to several trackers of different sizes and rates, for comparison. With --recording VIDEO: results on
// a recording of walking people, without truth.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "appliance/tracker/markerless/body_tracker.h"
#include "common/base/cpu_time.h"
#include "common/image/png.h"
#include "drivers/devices/make_camera.h"
#include "tests/data_sets/visitor_stories.h"

namespace cyclorama {
namespace {

constexpr double kDegree = 0.017453292519943295;
constexpr double kPicturesPerS = 30.0;

TimePoint at_time(double s) {
  return TimePoint(std::chrono::seconds(1000)) + std::chrono::duration_cast<Duration>(std::chrono::duration<double>(s));
}

/// Errors of one quantity.
struct Errors {
  std::vector<double> values;
  void add(double value) { values.push_back(value); }
  [[nodiscard]] double mean() const {
    double sum = 0.0;
    for (const double v : values) sum += v;
    return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
  }
  [[nodiscard]] double deviation() const {
    double sum = 0.0;
    for (const double v : values) sum += (v - mean()) * (v - mean());
    return values.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(values.size()));
  }
  [[nodiscard]] double p95() const {
    if (values.empty()) return 0.0;
    std::vector<double> sizes;
    for (const double v : values) sizes.push_back(std::abs(v));
    std::sort(sizes.begin(), sizes.end());
    return sizes[std::min(sizes.size() - 1, sizes.size() * 95 / 100)];
  }
};

struct Figures {
  Errors x, depth, lean;
  int pictures = 0;  ///< Those in which the visitor stands or steers.
  int found = 0;
  int bystanders = 0;  ///< Detections while there was no visitor.
  double jump_m = 0.0;
  double jump_rad = 0.0;
  std::vector<double> seconds;

  void add(const Figures& other) {
    for (auto [to, from] : {std::pair(&x, &other.x), {&depth, &other.depth}, {&lean, &other.lean}})
      to->values.insert(to->values.end(), from->values.begin(), from->values.end());
    pictures += other.pictures;
    found += other.found;
    bystanders += other.bystanders;
    jump_m = std::max(jump_m, other.jump_m);
    jump_rad = std::max(jump_rad, other.jump_rad);
    seconds.insert(seconds.end(), other.seconds.begin(), other.seconds.end());
  }
  [[nodiscard]] double median_ms() const {
    std::vector<double> sorted = seconds;
    std::sort(sorted.begin(), sorted.end());
    return sorted.empty() ? 0.0 : 1e3 * sorted[sorted.size() / 2];
  }
  [[nodiscard]] nlohmann::json json() const {
    return {{"found_share", pictures > 0 ? static_cast<double>(found) / pictures : 0.0},
            {"bystanders", bystanders},
            {"x_sd_m", x.deviation()},
            {"x_bias_m", x.mean()},
            {"x_p95_m", x.p95()},
            {"depth_sd_m", depth.deviation()},
            {"depth_bias_m", depth.mean()},
            {"depth_p95_m", depth.p95()},
            {"lean_sd_deg", lean.deviation() / kDegree},
            {"lean_bias_deg", lean.mean() / kDegree},
            {"lean_p95_deg", lean.p95() / kDegree},
            {"jump_m", jump_m},
            {"jump_deg", jump_rad / kDegree},
            {"median_ms", median_ms()},
            {"pictures", pictures}};
  }
};

void print_head() {
  std::printf(
      "%-28s  found  bystanders |  x: sd, bias, p95 mm  | depth: sd, bias, p95 mm | lean: sd, bias, p95 deg | jump mm, "
      "deg |  ms\n",
      "");
}
void print(const std::string& name, const Figures& f) {
  std::printf(
      "%-28s %5.1f %%  %5d     | %6.0f %6.0f %6.0f  | %6.0f %6.0f %6.0f    | %6.1f %6.1f %6.1f     | %5.0f %5.1f  | "
      "%5.2f\n",
      name.c_str(), f.pictures > 0 ? 100.0 * f.found / f.pictures : 0.0, f.bystanders, 1e3 * f.x.deviation(),
      1e3 * f.x.mean(), 1e3 * f.x.p95(), 1e3 * f.depth.deviation(), 1e3 * f.depth.mean(), 1e3 * f.depth.p95(),
      f.lean.deviation() / kDegree, f.lean.mean() / kDegree, f.lean.p95() / kDegree, 1e3 * f.jump_m,
      f.jump_rad / kDegree, f.median_ms());
  std::fflush(stdout);
}

/// One of the trackers that receive the same pictures.
struct Runner {
  int every = 1;  ///< Receives one in this many pictures.
  tracker::BodyTracker tracker;
  Figures figures{};
  std::optional<tracker::BodyPose> last{};

  void see(const GreyImage& picture, const Pinhole& lens, double t, const RenderedVisitor& truth) {
    const double begin = thread_cpu_seconds();
    const auto pose = tracker.update(picture, lens, at_time(t));
    figures.seconds.push_back(thread_cpu_seconds() - begin);
    const bool stands = t > 5.5;
    if (stands) ++figures.pictures;
    if (pose && t < 4.0) ++figures.bystanders;
    if (pose && last) {
      figures.jump_m =
          std::max({figures.jump_m, std::abs(pose->x_m - last->x_m), std::abs(pose->depth_m - last->depth_m)});
      figures.jump_rad = std::max(figures.jump_rad, std::abs(pose->lean_rad - last->lean_rad));
    }
    last = pose;
    if (!pose || !stands) return;
    ++figures.found;
    figures.x.add(pose->x_m - truth.x_m);
    figures.depth.add(pose->depth_m - truth.depth_m);
    figures.lean.add(pose->lean_rad - truth.lean_rad);
  }
};

std::vector<std::unique_ptr<Runner>> runners(const std::vector<std::pair<int, int>>& cells_and_every) {
  std::vector<std::unique_ptr<Runner>> all;
  for (const auto& [cells, every] : cells_and_every)
    all.push_back(std::make_unique<Runner>(Runner{every, tracker::BodyTracker({}, {.cells_across = cells})}));
  return all;
}

void tell(const VisitorStory& story, const Pinhole& lens, std::uint32_t seed,
          std::vector<std::unique_ptr<Runner>>* all) {
  const VisitorRoom room(lens, seed, story.noise_grey);
  for (int i = 0; i < static_cast<int>(19.0 * kPicturesPerS); ++i) {
    bool wanted = false;
    for (const auto& runner : *all) wanted = wanted || i % runner->every == 0;
    if (!wanted) continue;
    const double t = i / kPicturesPerS;
    const RenderedVisitor truth = story.visitor.at(t);
    std::vector<RenderedVisitor> people = story.others(t);
    people.push_back(truth);
    const GreyImage picture = room.picture(people, story.light(t), static_cast<std::uint64_t>(i));
    for (const auto& runner : *all) {
      if (i % runner->every == 0) runner->see(picture, lens, t, truth);
    }
  }
}

Pinhole lens_of(int width) { return Pinhole::from_field_of_view(width, width * 3 / 4, 60.0 * kDegree); }

nlohmann::json accuracy(bool quick) {
  nlohmann::json result;
  Figures all;
  std::printf("Rendered visitors before a camera of %d px across, %d cells, all stories\n", 320, 160);
  print_head();
  for (const VisitorStory& story : visitor_stories()) {
    Figures figures;
    for (std::uint32_t seed = 1; seed <= (quick ? 1u : 3u); ++seed) {
      auto runner = runners({{160, quick ? 2 : 1}});
      VisitorStory told = story;
      told.visitor.mark_x_m += 0.08 * (static_cast<double>(seed) - 2.0);
      told.visitor.mark_depth_m += 0.06 * (static_cast<double>(seed) - 2.0);
      told.visitor.looks.pattern_phase = seed;
      tell(told, lens_of(320), seed, &runner);
      figures.add(runner[0]->figures);
    }
    print(story.name, figures);
    result[story.name] = figures.json();
    all.add(figures);
  }
  print("all", all);
  result["all"] = all.json();
  return result;
}

nlohmann::json curve(bool quick, int only_width) {
  nlohmann::json points;
  std::printf("What size and rate cost and gain: alone, with somebody behind, in the wall's light\n");
  print_head();
  const std::vector<VisitorStory> stories = visitor_stories();
  for (const int width : only_width > 0 ? std::vector<int>{only_width}
                         : quick        ? std::vector<int>{320}
                                        : std::vector<int>{160, 320, 640}) {
    std::vector<std::pair<int, int>> knobs;
    for (const int cells : {80, 107, 160, 320}) {
      if (cells <= width) knobs.emplace_back(cells, quick ? 2 : 1);
    }
    for (const int every : {2, 3, 6}) {
      if (!quick && width == 320) knobs.emplace_back(160, every);
    }
    std::vector<Figures> figures(knobs.size());
    for (const std::size_t story : {std::size_t{0}, std::size_t{3}, std::size_t{5}}) {
      auto all = runners(knobs);
      tell(stories[story], lens_of(width), 2, &all);
      for (std::size_t i = 0; i < knobs.size(); ++i) figures[i].add(all[i]->figures);
    }
    for (std::size_t i = 0; i < knobs.size(); ++i) {
      const double rate = kPicturesPerS / knobs[i].second;
      char name[64];
      std::snprintf(name, sizeof name, "%d px, %d cells, %.0f/s", width, knobs[i].first, rate);
      print(name, figures[i]);
      nlohmann::json point = figures[i].json();
      point["width_px"] = width;
      point["cells"] = knobs[i].first;
      point["pictures_per_s"] = rate;
      points.push_back(point);
    }
  }
  return points;
}

/// Results on a recording: number and duration of the periods in which somebody is followed, and jumps of poses.
nlohmann::json recording(const std::string& path, double field_of_view_deg, double mark_distance_m,
                         const std::string& out) {
  auto camera = devices::make_camera("file:" + path + "?loop=no&frames_per_second=10", SteadyClock());
  if (!camera || !(*camera)->start()) {
    std::fprintf(stderr, "cannot read %s\n", path.c_str());
    return nullptr;
  }
  tracker::BodySettings settings;
  settings.mark_distance_m = mark_distance_m;
  settings.follow_radius_m = 0.45 * mark_distance_m;
  settings.begin_within_m = 0.4 * mark_distance_m;
  tracker::BodyTracker tracker(settings);
  const SteadyClock clock;
  int pictures = 0, found = 0, visits = 0;
  double jump_m = 0.0;
  std::optional<tracker::BodyPose> last;
  while (true) {
    const auto frame = (*camera)->next_frame(clock.now() + std::chrono::seconds(2));
    if (!frame) break;
    const GreyImage& grey = (*frame)->pixels;
    const Pinhole lens = Pinhole::from_field_of_view(grey.width(), grey.height(), field_of_view_deg * kDegree);
    const auto pose = tracker.update(grey, lens, (*frame)->captured_at);
    ++pictures;
    found += pose ? 1 : 0;
    visits += pose && !last ? 1 : 0;
    if (pose && last) jump_m = std::max(jump_m, std::hypot(pose->x_m - last->x_m, pose->depth_m - last->depth_m));
    last = pose;
    if (!out.empty() && pictures % 20 == 0)
      static_cast<void>(write_png(out + "/" + std::to_string(pictures) + ".png", tracker.drawn(grey)));
  }
  std::printf(
      "%s: %d pictures, somebody followed in %d of them, %d times taken in, at most %.2f m from picture to picture\n",
      path.c_str(), pictures, found, visits, jump_m);
  return {{"pictures", pictures}, {"found", found}, {"taken_in", visits}, {"jump_m", jump_m}};
}

}  // namespace
}  // namespace cyclorama

int main(int argc, char** argv) {
  CLI::App app("Measures steering without a pattern.");
  std::string json, video, out;
  bool quick = false;
  int width = 0;
  double field_of_view_deg = 50.0, mark_distance_m = 10.0;
  app.add_flag("--quick", quick);
  app.add_option("--width", width, "only the curve, at this width of the picture")->check(CLI::Range(80, 1920));
  app.add_option("--json", json);
  app.add_option("--recording", video);
  app.add_option("--field-of-view-deg", field_of_view_deg);
  app.add_option("--mark-distance-m", mark_distance_m);
  app.add_option("--pictures", out, "every 20th picture of the recording, drawn, goes to this folder");
  CLI11_PARSE(app, argc, argv);
  nlohmann::json figures;
  if (video.empty()) {
    if (width == 0) figures["accuracy"] = cyclorama::accuracy(quick);
    figures["points"] = cyclorama::curve(quick, width);
  } else {
    figures["recording"] = cyclorama::recording(video, field_of_view_deg, mark_distance_m, out);
  }
  if (json.empty()) {
    std::printf("%s\n", figures.dump().c_str());
  } else {
    std::ofstream(json) << figures;
  }
  return 0;
}
