// SPDX-License-Identifier: Apache-2.0
/// cyclorama-bench-walk: what a visitor sees while walking, against the truth at every refresh.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "kiosk/tour/session/site.h"
#include "renderfarm/node/embree_block_renderer.h"
#include "tests/bench/walk/walk_case.h"
#include "tests/bench/walk/walk_cost.h"

namespace cyclorama {
namespace {

struct Options {
  std::string scene;
  std::string json;
  std::string pictures_to;
  std::vector<int> fps{5, 10, 20};
  std::vector<int> latencies_ms{100, 200, 400};
  std::vector<int> walks{0, 1, 2};
  double jitter_ms = 0.0;
  bool all_methods = false;
  int cost_rounds = 0;
  WalkPictures pictures;
};

nlohmann::json to_json(const WalkFigures& figures) {
  return {{"psnr", figures.psnr_db},        {"ssim", figures.ssim},
          {"flip", figures.flip},           {"worst_psnr", figures.worst_psnr_db},
          {"switch", figures.switch_share}, {"step", figures.step_share},
          {"holes", figures.holes},         {"depth_share", figures.depth_share}};
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
  (*json)["renderer"] = costs.renderer;
  return Done{};
}

Status measure(const Options& options, nlohmann::json* json) {
  TRY_ASSIGN(const std::unique_ptr<node::BlockRenderer> renderer,
             node::embree_scene_loader(0)(options.scene, [](double) {}));
  wire::SceneDescription description = renderer->description();
  description.set_name("scene");
  std::string warning;
  const tour::Site site = tour::site_of(description, &warning);
  if (!warning.empty()) fmt::print("{}\n", warning);
  fmt::print("{:<9}{:>4}{:>5}  {:<22}{:>7}{:>7}{:>7}{:>8}{:>8}{:>8}{:>8}{:>8}\n", "walk", "fps", "ms", "display",
             "PSNR", "worst", "SSIM", "FLIP", "switch", "between", "holes", "depth");
  for (const int walk : options.walks) {
    TRY_ASSIGN(const std::unique_ptr<WalkCase> walked,
               WalkCase::make(renderer.get(), site, description.start_eye_m().y(), static_cast<WalkKind>(walk),
                              options.pictures));
    for (const int fps : options.fps) {
      for (const int latency_ms : options.latencies_ms) {
        for (const WalkMethod& method : walk_methods()) {
          if (!options.all_methods && !(method.predicts && method.moves)) continue;
          TRY_ASSIGN(const WalkFigures figures,
                     walked->measure({fps, latency_ms, options.jitter_ms}, method, options.pictures_to));
          const char* const name = to_text(walked->path().kind());
          fmt::print("{:<9}{:>4}{:>5}  {:<22}{:>7.2f}{:>7.2f}{:>7.4f}{:>8.4f}{:>7.0f}%{:>7.0f}%{:>7.2f}%{:>7.1f}%\n",
                     name, fps, latency_ms, method.name, figures.psnr_db, figures.worst_psnr_db, figures.ssim,
                     figures.flip, 100 * figures.switch_share, 100 * figures.step_share, 100 * figures.holes,
                     100 * figures.depth_share);
          std::fflush(stdout);
          (*json)[fmt::format("{}, {} fps, {} ms, {}", name, fps, latency_ms, method.name)] = to_json(figures);
        }
      }
    }
    fmt::print("{} walked {:.2f} m\n", to_text(walked->path().kind()), walked->path().length_m());
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
  program.add_option("scene", options.scene, "Folder of a scene; its stored light is used if it has some");
  program.add_option("--json", options.json, "Also write the figures, as JSON");
  program.add_option("--pictures", options.pictures_to, "Folder for each case's worst refresh, beside the truth");
  program.add_option("--fps", options.fps, "Frames of the farm each second");
  program.add_option("--latency-ms", options.latencies_ms, "From asking for a view to showing it");
  program.add_option("--walks", options.walks, "0: ahead, 1: sideways, 2: a turn");
  program.add_option("--jitter-ms", options.jitter_ms, "Frames are late by up to this much");
  program.add_flag("--all-methods", options.all_methods, "Also displays that hold the last picture, and others");
  program.add_option("--width", options.pictures.width, "Of the wall's picture, in pixels");
  program.add_option("--height", options.pictures.height, "Of the wall's picture, in pixels");
  program.add_option("--scale", options.pictures.scale, "Size of the farm's frames over the wall's, each way");
  program.add_option("--samples", options.pictures.samples, "Per pixel");
  program.add_option("--truth-samples", options.pictures.truth_samples, "Per pixel of the pictures that judge");
  program.add_option("--jpeg-quality", options.pictures.jpeg_quality, "Of frames; 0: no JPEG");
  program.add_option("--mesh-cells", options.pictures.mesh_cells, "Cells of depth between two vertices of the mesh");
  program.add_option("--cost", options.cost_rounds,
                     "Instead: what moving a frame costs, over so many rounds; no scene");
  program.add_option("--refreshes", options.pictures.refreshes, "Length of each walk, at 60 a second");
  program.add_option("--span-deg", span_deg, "Angle of the wall");
  CLI11_PARSE(program, argc, argv);
  options.pictures.span_rad = span_deg * 3.14159265358979323846 / 180.0;
  nlohmann::json json = nlohmann::json::object();
  if (options.scene.empty() && options.cost_rounds == 0) {
    fmt::print(stderr, "cyclorama-bench-walk: name a scene's folder, or --cost ROUNDS\n");
    return 2;
  }
  const Status done = options.cost_rounds > 0 ? measure_cost(options, &json) : measure(options, &json);
  if (!done) {
    fmt::print(stderr, "cyclorama-bench-walk: {}\n", done.error().message());
    return 1;
  }
  if (options.json.empty()) return 0;
  std::ofstream out(options.json);
  out << json.dump();
  return out.flush() ? 0 : 1;
}
