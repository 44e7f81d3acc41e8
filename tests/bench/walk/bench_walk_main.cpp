// SPDX-License-Identifier: Apache-2.0
/// cyclorama-bench-walk: what a visitor sees while walking, against the truth at every refresh.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "common/base/file.h"
#include "kiosk/tour/session/site.h"
#include "renderfarm/node/embree_block_renderer.h"
#include "tests/bench/walk/walk_case.h"
#include "tests/bench/walk/walk_cost.h"

namespace cyclorama {
namespace {

constexpr double kUnevenJitter_ms = 80.0;
constexpr int kFixedLatency_ms = 70;      ///< From asking to showing, beside a frame's own time on the farm.
constexpr double kUnevenLostShare = 0.3;  ///< Enough that a walk of a second and a half loses some.

struct Options {
  std::vector<std::string> scenes;  ///< Arguments of parsed_scene().
  std::string json;
  std::string pictures_to;
  std::vector<int> fps{5, 10, 20};
  std::vector<int> latencies_ms{100, 200, 400};
  std::vector<int> walks{0, 1, 2};
  double jitter_ms = 0.0;
  double lost_share = 0.0;
  bool uneven = false;
  bool all_methods = false;
  bool flicker = false;
  bool trade = false;
  int cost_rounds = 0;
  WalkPictures pictures;
};

nlohmann::json to_json(const WalkFigures& figures) {
  return {{"psnr", figures.psnr_db},
          {"ssim", figures.ssim},
          {"flip", figures.flip},
          {"worst_psnr", figures.worst_psnr_db},
          {"switch", figures.switch_share},
          {"step", figures.step_share},
          {"motion", figures.motion},
          {"flicker", figures.flicker},
          {"holes", figures.holes},
          {"depth_share", figures.depth_share},
          {"cpu_s_per_frame", figures.cpu_s_per_frame}};
}

Status measure_cost(const Options& options, nlohmann::json* json) {
  TRY_ASSIGN(const WalkCosts costs, walk_costs(options.pictures.width, options.pictures.height, options.cost_rounds));
  fmt::print("{}x{}, {}\n", options.pictures.width, options.pictures.height, costs.renderer);
  for (const WalkCost& cost : costs.each) {
    const double ratio = cost.cpu_ms / costs.each.front().cpu_ms;
    const std::string name = cost.mesh_cells == 0 ? "as it came" : fmt::format("moved, 1/{}", 4 * cost.mesh_cells);
    fmt::print("{:<12}{:>8.2f} cpu-ms{:>8.2f} ms{:>7.2f} x\n", name, cost.cpu_ms, cost.wall_ms, ratio);
    if (cost.mesh_cells > 0) (*json)["ratio_blit"][fmt::format("1/{}", 4 * cost.mesh_cells)] = ratio;
  }
  const double blit_ms = costs.each.front().cpu_ms;
  fmt::print("a new frame {:.2f} cpu-ms, {:.2f} x; reusing earlier ones {:.2f} cpu-ms, {:.2f} x\n", costs.taken.cpu_ms,
             costs.taken.cpu_ms / blit_ms, costs.reusing.cpu_ms, costs.reusing.cpu_ms / blit_ms);
  (*json)["ratio_new_frame"] = costs.taken.cpu_ms / blit_ms;
  (*json)["ratio_reusing"] = costs.reusing.cpu_ms / blit_ms;
  (*json)["renderer"] = costs.renderer;
  return Done{};
}

/// A scene's renderer, and where its visitors walk.
struct WalkedScene {
  std::unique_ptr<node::BlockRenderer> renderer;
  tour::Site site;
  double eye_height_m = 0.0;
};

struct SceneArgument {
  std::string name;
  std::string path;
  std::string light;  ///< Empty: the scene's own, if it has some.
};

/// Reads NAME=SCENE or NAME=SCENE,LIGHT.
SceneArgument parsed_scene(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::size_t comma = text.find(',', equals);
  if (equals == std::string::npos) return {"scene", text, ""};
  return {text.substr(0, equals), text.substr(equals + 1, comma - equals - 1),
          comma == std::string::npos ? "" : text.substr(comma + 1)};
}

Result<WalkedScene> open_scene(const SceneArgument& of) {
  WalkedScene scene;
  TRY_ASSIGN(scene.renderer, node::embree_scene_loader(std::make_shared<render::Crew>(0))(of.path, [](double) {}));
  if (!of.light.empty()) {
    TRY_ASSIGN(const MappedFile file, MappedFile::open(of.light));
    TRY(scene.renderer->add_light(file.bytes(), of.light));
  }
  if (!scene.renderer->note().empty()) fmt::print("{}\n", scene.renderer->note());
  wire::SceneDescription description = scene.renderer->description();
  description.set_name("scene");
  std::string warning;
  scene.site = tour::site_of(description, &warning);
  if (!warning.empty()) fmt::print("{}\n", warning);
  scene.eye_height_m = description.start_eye_m().y();
  return scene;
}

void print_header() {
  fmt::print("{:<9}{:>4}{:>5}  {:<38}{:>7}{:>7}{:>7}{:>8}{:>8}{:>8}{:>8}{:>9}{:>8}{:>8}\n", "walk", "fps", "ms",
             "display", "PSNR", "worst", "SSIM", "FLIP", "switch", "between", "motion", "flicker", "holes", "depth");
}

void print_row(const WalkCase& walked, const WalkFarm& farm, const std::string& name, const WalkFigures& figures) {
  fmt::print(
      "{:<9}{:>4}{:>5}  {:<38}{:>7.2f}{:>7.2f}{:>7.4f}{:>8.4f}{:>7.0f}%{:>7.0f}%{:>8.2f}{:>9.2f}{:>7.2f}%{:>7.1f}%\n",
      to_text(walked.path().kind()), farm.fps, farm.latency_ms, name, figures.psnr_db, figures.worst_psnr_db,
      figures.ssim, figures.flip, 100 * figures.switch_share, 100 * figures.step_share, figures.motion, figures.flicker,
      100 * figures.holes, 100 * figures.depth_share);
  std::fflush(stdout);
}

/// The farms of a run: all rates and latencies, and the first of them once more with late frames and with lost ones.
std::vector<WalkFarm> farms_of(const Options& options) {
  std::vector<WalkFarm> farms;
  for (const int fps : options.fps) {
    for (const int latency_ms : options.latencies_ms)
      farms.push_back({fps, latency_ms, options.jitter_ms, options.lost_share});
  }
  if (!options.uneven) return farms;
  farms.push_back(farms.front());
  farms.back().jitter_ms = kUnevenJitter_ms;
  farms.push_back(farms.front());
  farms.back().lost_share = kUnevenLostShare;
  return farms;
}

std::string unevenness_of(const WalkFarm& farm) {
  std::string text;
  if (farm.jitter_ms > 0.0) text += fmt::format(", up to {} ms late", farm.jitter_ms);
  if (farm.lost_share > 0.0) text += fmt::format(", {:.0f} % lost", 100 * farm.lost_share);
  return text;
}

Status measure(const Options& options, const SceneArgument& of, nlohmann::json* json) {
  TRY_ASSIGN(const WalkedScene scene, open_scene(of));
  if (!scene.renderer->light_versions()->newest()) fmt::print("without stored light: path traced and denoised\n");
  print_header();
  for (const int walk : options.walks) {
    TRY_ASSIGN(const std::unique_ptr<WalkCase> walked,
               WalkCase::make(scene.renderer.get(), scene.site, scene.eye_height_m, static_cast<WalkKind>(walk),
                              options.pictures));
    for (const WalkFarm& farm : farms_of(options)) {
      for (const WalkMethod& method : walk_methods()) {
        if (!options.all_methods && !method.reuses) continue;
        TRY_ASSIGN(const WalkFigures figures, walked->measure(farm, method, options.pictures_to));
        print_row(*walked, farm, method.name + unevenness_of(farm), figures);
        const std::string by = options.all_methods ? std::string(", ") + method.name : "";
        const std::string name =
            fmt::format("{}, {} fps, {} ms", to_text(walked->path().kind()), farm.fps, farm.latency_ms);
        (*json)[name + unevenness_of(farm) + by] = to_json(figures);
      }
    }
    const int first =
        static_cast<int>(std::lround(options.latencies_ms.front() * options.pictures.refresh_hz / 1000.0));
    TRY_ASSIGN(const WalkFigures anew, walked->measure_anew(first));
    print_row(*walked, {static_cast<int>(options.pictures.refresh_hz), 0}, "rendered anew at each refresh", anew);
    (*json)[fmt::format("{}, rendered anew", to_text(walked->path().kind()))] = to_json(anew);
    fmt::print("{} walked {:.2f} m\n", to_text(walked->path().kind()), walked->path().length_m());
  }
  return Done{};
}

double rms_error(const WalkFigures& figures) { return 255.0 * std::pow(10.0, -figures.psnr_db / 20.0); }

/// Compares a display that remembers, and frames that read stored light or are path traced and denoised, with frames
/// that are path traced and shown as they come, at the same cost.
Status measure_flicker(const Options& options, const SceneArgument& of, nlohmann::json* json) {
  TRY_ASSIGN(const WalkedScene scene, open_scene(of));
  if (!scene.renderer->light_versions()->newest()) {
    return Error(ErrorCode::kInvalidArgument, of.name + " has no stored light, so there is nothing to compare");
  }
  const WalkFarm farm{options.fps.front(), options.latencies_ms.front(), options.jitter_ms, options.lost_share};
  const WalkMethod reusing = walk_methods().back();
  WalkMethod as_they_come = reusing;
  as_they_come.reuses = false;
  print_header();
  for (const int walk : options.walks) {
    TRY_ASSIGN(const std::unique_ptr<WalkCase> walked,
               WalkCase::make(scene.renderer.get(), scene.site, scene.eye_height_m, static_cast<WalkKind>(walk),
                              options.pictures));
    const auto row = [&](const std::string& name, const WalkMethod& method) -> Result<WalkFigures> {
      TRY_ASSIGN(const WalkFigures figures, walked->measure(farm, method, options.pictures_to));
      print_row(*walked, farm, name, figures);
      (*json)[to_text(walked->path().kind())][name] = to_json(figures);
      return figures;
    };
    TRY_ASSIGN(const WalkFigures stored, row("stored light", as_they_come));
    TRY_ASSIGN(const WalkFigures stored_reusing, row("stored light, reusing", reusing));
    WalkFrames frames = options.pictures.frames;
    frames.stored_light = false;
    walked->set_frames(frames);
    TRY_ASSIGN(const WalkFigures same_size, row("paths, same size", as_they_come));
    frames.scale *= std::sqrt(stored.cpu_s_per_frame / same_size.cpu_s_per_frame);
    walked->set_frames(frames);
    TRY_ASSIGN(const WalkFigures paths, row("paths, same cost", as_they_come));
    TRY_ASSIGN(const WalkFigures paths_reusing, row("paths, reusing", reusing));
    fmt::print("cpu-s per frame: stored light {:.3f}, paths {:.3f} at {:.2f} of the size, {:.3f} at {:.2f}\n",
               stored.cpu_s_per_frame, same_size.cpu_s_per_frame, options.pictures.frames.scale, paths.cpu_s_per_frame,
               frames.scale);
    const auto add = [&](const std::string& which, const WalkFigures& now, const WalkFigures& before) {
      nlohmann::json& ratios = (*json)[to_text(walked->path().kind())][which];
      ratios["ratio_before"] = now.flicker / before.flicker;
      ratios["error_ratio_before"] = rms_error(now) / rms_error(before);
    };
    add("all", stored_reusing, paths);
    add("reuse of stored light", stored_reusing, stored);
    add("reuse of paths", paths_reusing, paths);
  }
  return Done{};
}

/// Few large frames and many small ones: as many pixels each second as frames of whole size at the lowest rate.
Status measure_trade(const Options& options, const SceneArgument& of, nlohmann::json* json) {
  TRY_ASSIGN(const WalkedScene scene, open_scene(of));
  const int lowest_fps = *std::ranges::min_element(options.fps);
  print_header();
  for (const int walk : options.walks) {
    TRY_ASSIGN(const std::unique_ptr<WalkCase> walked,
               WalkCase::make(scene.renderer.get(), scene.site, scene.eye_height_m, static_cast<WalkKind>(walk),
                              options.pictures));
    for (const int fps : options.fps) {
      WalkFrames frames = options.pictures.frames;
      frames.scale *= std::sqrt(static_cast<double>(lowest_fps) / fps);
      walked->set_frames(frames);
      const WalkFarm farm{fps, kFixedLatency_ms + 1000 / fps, options.jitter_ms, options.lost_share};
      for (const WalkMethod& method : walk_methods()) {
        if (!method.moves || !method.predicts) continue;
        TRY_ASSIGN(const WalkFigures figures, walked->measure(farm, method, options.pictures_to));
        print_row(*walked, farm, fmt::format("{}, {:.0f} %", method.name, 100 * frames.scale), figures);
        fmt::print("{:>60.3f} cpu-s each second\n", fps * figures.cpu_s_per_frame);
        (*json)[to_text(walked->path().kind())][fmt::format("{} fps, {}", fps, method.name)] = to_json(figures);
      }
    }
  }
  return Done{};
}

Status run(const Options& options, nlohmann::json* json) {
  if (options.cost_rounds > 0) return measure_cost(options, json);
  for (const std::string& text : options.scenes) {
    const SceneArgument scene = parsed_scene(text);
    if (!std::filesystem::exists(scene.path)) {
      fmt::print("{} is left out: there is no {}\n", scene.name, scene.path);
      continue;
    }
    fmt::print("{}\n", scene.name);
    Options own = options;
    if (!own.pictures.truth_in.empty()) {
      own.pictures.truth_in /= scene.name;
      std::filesystem::create_directories(own.pictures.truth_in);
    }
    nlohmann::json* const figures = &(*json)[scene.name];
    const auto measured = options.trade ? measure_trade : options.flicker ? measure_flicker : measure;
    TRY(measured(own, scene, figures));
  }
  return Done{};
}

}  // namespace
}  // namespace cyclorama

// NOLINTNEXTLINE(bugprone-exception-escape): it may end the benchmark.
int main(int argc, char** argv) {
  using namespace cyclorama;  // NOLINT(google-build-using-namespace)
  CLI::App program("Walks through a scene, shows it as a display does, and compares with the truth at every refresh.");
  Options options;
  double span_deg = 150.0;
  program.add_option("scenes", options.scenes,
                     "NAME=SCENE or NAME=SCENE,LIGHT each; a scene's own stored light is used if it has some");
  program.add_option("--json", options.json, "Also write the figures, as JSON");
  program.add_option("--pictures", options.pictures_to, "Folder for each case's worst refresh, beside the truth");
  program.add_option("--fps", options.fps, "Frames of the farm each second");
  program.add_option("--latency-ms", options.latencies_ms, "From asking for a view to showing it");
  program.add_option("--walks", options.walks, "0: ahead, 1: sideways, 2: a turn");
  program.add_option("--jitter-ms", options.jitter_ms, "Frames are late by up to this much");
  program.add_option("--lost-share", options.lost_share, "Share of the frames that never come")
      ->check(CLI::Range(0.0, 0.9));
  program.add_flag("--uneven", options.uneven, "Also the first farm with late frames, and with lost ones");
  program.add_flag("--flicker", options.flicker, "Instead: frames of stored light beside path traced ones");
  program.add_flag("--trade", options.trade,
                   "Instead: rates of frames whose size makes their cost each second equal; whole size at the lowest");
  program.add_flag("--all-methods", options.all_methods, "Also displays that hold the last picture, and others");
  program.add_option("--width", options.pictures.width, "Of the wall's picture, in pixels");
  program.add_option("--height", options.pictures.height, "Of the wall's picture, in pixels");
  program.add_option("--scale", options.pictures.frames.scale, "Size of the farm's frames over the wall's, each way");
  program.add_option("--samples", options.pictures.frames.samples, "Per pixel");
  program.add_option("--truth-in", options.pictures.truth_in,
                     "Folder that keeps the pictures that judge, by scene, for later runs with the same scenes");
  program.add_option("--truth-samples", options.pictures.truth_samples, "Per pixel of the pictures that judge");
  program.add_option("--jpeg-quality", options.pictures.frames.jpeg_quality,
                     "Of frames; 0: they reach the display without");
  program.add_flag("--without-card", options.pictures.without_card,
                   "As a display on a software renderer filters; with --mesh-cells 2 it is wholly that");
  program.add_option("--mesh-cells", options.pictures.frames.mesh_cells,
                     "Cells of depth between two vertices of the mesh");
  program.add_flag("--fine-depth", options.pictures.frames.fine_depth,
                   "The display gets the depth of each pixel and a mesh as fine, which no frame can carry");
  program.add_option("--cost", options.cost_rounds,
                     "Instead: what moving a frame costs, over so many rounds; no scene");
  program.add_option("--refreshes", options.pictures.refreshes, "Length of each walk, at 60 a second");
  program.add_option("--span-deg", span_deg, "Angle of the wall");
  CLI11_PARSE(program, argc, argv);
  options.pictures.span_rad = span_deg * 3.14159265358979323846 / 180.0;
  nlohmann::json json = nlohmann::json::object();
  if (options.scenes.empty() && options.cost_rounds == 0) {
    fmt::print(stderr, "cyclorama-bench-walk: name a scene as NAME=SCENE, or --cost ROUNDS\n");
    return 2;
  }
  const Status done = run(options, &json);
  if (!done) {
    fmt::print(stderr, "cyclorama-bench-walk: {}\n", done.error().message());
    return 1;
  }
  if (options.json.empty()) return 0;
  std::ofstream out(options.json);
  out << json.dump();
  return out.flush() ? 0 : 1;
}
