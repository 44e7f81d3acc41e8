// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/light_bake_command.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/process/progress.h"
#include "renderfarm/light_baking/bake_light.h"
#include "renderfarm/light_baking/check_light.h"

namespace cyclorama {
namespace {

/// Pixels of the frames after which light is worth its cost.
constexpr double kFrameMpx = 1920.0 * 1080.0 * 1e-6;

struct LightBakeOptions {
  tools::SceneOptions scene;
  std::string name;
  light_baking::BakeSettings bake;
  light_baking::CheckSettings check{.eyes = 32, .width = 128, .height = 48, .samples = 16, .reference_samples = 32};
  std::string json;
};

Status measure(const LightBakeOptions& options, const StopSignal& stop) {
  TRY_ASSIGN(tools::LoadedScene loaded, tools::load_with_progress(options.scene));
  TRY_ASSIGN(const std::unique_ptr<render::Renderer> renderer,
             tools::build_with_progress(std::move(loaded.scene), options.scene));
  const auto cancelled = [&] { return stop.requested(); };
  Progress computing("computing light");
  TRY_ASSIGN(const light_baking::BakedLight baked, light_baking::bake_light(
                                                       *renderer, options.bake, options.scene.threads,
                                                       [&](double done) { computing.update(done); }, cancelled));
  const double per_million_seen = 1e6 * baked.cpu_seconds / static_cast<double>(baked.seen_triangles);
  const double bytes_per_triangle =
      static_cast<double>(baked.store->bytes()) / static_cast<double>(renderer->scene().triangles_seen());
  for (const light_baking::BakeStage& stage : baked.stages)
    fmt::print("{:<20}{:>8.1f} cpu-s\n", stage.name, stage.cpu_seconds);
  fmt::print(
      "{:<20}{:>8.1f} cpu-s, {:.0f} per million of {} seen triangles; {:.1f} bytes per triangle, {} grids, {} "
      "vertices hidden, standard error p50 {:.2f} %, p95 {:.2f} %\n",
      "light", baked.cpu_seconds, per_million_seen, baked.seen_triangles, bytes_per_triangle, baked.grids,
      baked.hidden_vertices, 100.0f * baked.store->relative_errors().p50, 100.0f * baked.store->relative_errors().p95);
  fmt::print("a thread works for at most {:.2f} ms between two looks at whether it must end\n",
             1e3 * baked.max_run_seconds);
  Progress checking("checking light");
  TRY_ASSIGN(const light_baking::CheckedLight checked,
             light_baking::check_light(
                 *renderer, options.check, [&](double done) { checking.update(done); }, cancelled));
  const light::LightCheck& check = checked.check;
  const double saved_per_frame = kFrameMpx * (checked.paths_cpu_s_per_mpx - checked.stored_cpu_s_per_mpx);
  const double pays_off_after_frames = baked.cpu_seconds / saved_per_frame;
  fmt::print(
      "{} eyes: relMSE p50 {:.5f} p99 {:.5f}; 8x8 p50 {:.1e} p99 {:.1e}; FLIP p50 {:.4f} p99 {:.4f}; bias {:.3f} %; "
      "worst block off by {:.1f} codes\n",
      check.eyes, check.relmse.p50, check.relmse.p99, check.block_relmse.p50, check.block_relmse.p99, check.flip.p50,
      check.flip.p99, 100.0f * check.bias, check.worst_codes);
  fmt::print(
      "pictures of {} samples: {:.2f} cpu-s per Mpx stored, {:.2f} traced; light pays off after {:.0f} "
      "frames of 1080p; the check took {:.1f} cpu-s\n",
      options.check.samples, checked.stored_cpu_s_per_mpx, checked.paths_cpu_s_per_mpx, pays_off_after_frames,
      checked.cpu_seconds);
  if (options.json.empty()) return Done{};
  nlohmann::json stages;
  for (const light_baking::BakeStage& stage : baked.stages) stages[stage.name] = stage.cpu_seconds;
  const std::string name =
      options.name.empty() ? std::filesystem::path(options.scene.scene).filename().string() : options.name;
  return tools::write_json(options.json, {{name,
                                           {{"bake_cpu_s", baked.cpu_seconds},
                                            {"stages_cpu_s", stages},
                                            {"seen_triangles", baked.seen_triangles},
                                            {"cpu_s_per_million_seen", per_million_seen},
                                            {"bytes_per_triangle", bytes_per_triangle},
                                            {"max_run_ms", 1e3 * baked.max_run_seconds},
                                            {"relmse_p50", check.relmse.p50},
                                            {"relmse_8x8_p50", check.block_relmse.p50},
                                            {"relmse_8x8_p99", check.block_relmse.p99},
                                            {"flip_p50", check.flip.p50},
                                            {"bias", check.bias},
                                            {"worst_codes", check.worst_codes},
                                            {"check_cpu_s", checked.cpu_seconds},
                                            {"pays_off_after_frames", pays_off_after_frames}}}});
}

}  // namespace

tools::RenderCommand add_light_bake_command(CLI::App* program) {
  CLI::App* const parser =
      program->add_subcommand("light-bake", "Cost of a scene's light by stages, and its error from held-out eyes");
  const auto options = std::make_shared<LightBakeOptions>();
  options->bake.check_eyes = 0;  // This command has a check of its own.
  tools::add_scene_options(parser, &options->scene);
  parser->add_option("--name", options->name, "The scene's name in the figures; default: its folder's");
  parser->add_option("--eyes", options->check.eyes, "Held-out eyes")->check(CLI::Range(1, 1024))->capture_default_str();
  parser->add_option("--width", options->check.width, "Pictures' width in pixels")->capture_default_str();
  parser->add_option("--height", options->check.height, "Pictures' height in pixels")->capture_default_str();
  parser->add_option("--samples", options->check.samples, "Samples of pictures")->capture_default_str();
  parser->add_option("--reference-samples", options->check.reference_samples, "Samples of each half of the reference")
      ->capture_default_str();
  parser->add_option("--rays", options->bake.final_rays, "As cyclorama-render light; a power of two")
      ->capture_default_str();
  parser->add_option("--light-rays", options->bake.max_light_rays, "As cyclorama-render light")->capture_default_str();
  parser->add_option("--max-parts", options->bake.max_parts, "As cyclorama-render light; a power of two")
      ->capture_default_str();
  parser->add_option("--bytes-per-triangle", options->bake.bytes_per_triangle, "As cyclorama-render light")
      ->capture_default_str();
  parser->add_option("--min-bytes", options->bake.min_bytes, "Least budget for all samples, in bytes")
      ->capture_default_str();
  parser->add_option("--json", options->json, "Also write the figures as JSON");
  return {parser, [options](const StopSignal& stop) { return measure(*options, stop); }};
}

}  // namespace cyclorama
