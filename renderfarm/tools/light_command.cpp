// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/tools/light_command.h"

#include <fmt/format.h>

#include <bit>
#include <nlohmann/json.hpp>

#include "common/process/progress.h"
#include "renderfarm/light/light_file.h"
#include "renderfarm/light_baking/bake_light.h"
#include "renderfarm/light_baking/piece_folder.h"
#include "renderfarm/render/memory.h"

namespace cyclorama::tools {
namespace {

struct LightOptions {
  SceneOptions scene;
  std::string out;
  std::string json;
  bool if_needed = false;
  light_baking::BakeSettings settings;
};

nlohmann::json json_of(const light::Percentiles& values) {
  return {{"p50", values.p50}, {"p95", values.p95}, {"p99", values.p99}};
}

nlohmann::json json_of(const light::LightCheck& check) {
  return {{"eyes", check.eyes},
          {"reference_samples", check.reference_samples},
          {"relmse", json_of(check.relmse)},
          {"relmse_8x8", json_of(check.block_relmse)},
          {"flip", json_of(check.flip)},
          {"bias", check.bias},
          {"relmse_of_paths_at_equal_cost", check.relmse_of_paths},
          {"loses_to_paths", check.loses_to_paths()},
          {"worst_eye_m", check.worst_eye},
          {"worst_heading_rad", check.worst_heading_rad},
          {"worst_codes", check.worst_codes},
          {"worst_block_px", check.worst_block_px},
          {"picture_px", {check.picture_width_px, check.picture_height_px}}};
}

/// Returns true if the file has light that the renderer can use; prints why not, if there is a file.
bool has_usable_light(const render::Renderer& renderer, const std::filesystem::path& file) {
  const Result<light::LightStore> store = light::read_light_file(file);
  if (!store && store.error().code() == ErrorCode::kNotFound) return false;
  const Status usable = store ? renderer.check_light(*store, file.string()) : Status(store.error());
  if (!usable) fmt::print("{}: doing so now\n", usable.error().message());
  return usable.has_value();
}

Status compute_light(const LightOptions& options, const StopSignal& stop) {
  std::filesystem::path out = options.out;
  if (out.empty()) {
    if (!std::filesystem::is_directory(options.scene.scene)) {
      return Error(ErrorCode::kInvalidArgument,
                   fmt::format("{} is not a scene's folder: name the file to write with --out", options.scene.scene));
    }
    out = std::filesystem::path(options.scene.scene) / light::kLightFileName;
  }
  TRY_ASSIGN(LoadedScene loaded, load_with_progress(options.scene));
  if (stop.requested()) return stopped();
  TRY_ASSIGN(const std::unique_ptr<render::Renderer> renderer,
             build_with_progress(std::move(loaded.scene), options.scene));
  if (options.if_needed && has_usable_light(*renderer, out)) {
    fmt::print("{}: it has the light of this scene\n", out.string());
    return Done{};
  }
  light_baking::BakeSettings settings = options.settings;
  settings.final_rays = static_cast<int>(std::bit_floor(static_cast<unsigned>(settings.final_rays)));
  settings.max_parts = static_cast<int>(std::bit_floor(static_cast<unsigned>(settings.max_parts)));
  // A run that was ended goes on where it was.
  light_baking::KeptPieces pieces(light_baking::unfinished_light(out));
  Progress progress("computing light");
  TRY_ASSIGN(const light_baking::BakedLight baked,
             light_baking::bake_light(
                 *renderer, settings, options.scene.threads, [&](double fraction) { progress.update(fraction); },
                 [&] { return stop.requested(); }, &pieces));
  TRY(light::write_light_file(out, *baked.store));
  pieces.remove();
  const auto triangles = static_cast<double>(renderer->scene().triangles_seen());
  const double bytes_per_triangle = static_cast<double>(baked.store->bytes()) / triangles;
  fmt::print(
      "{}: {}, {:.1f} bytes per triangle; {} samples, {} triangles with a grid; visitors see {:.0f} % of {:.0f} "
      "triangles; {:.1f} cpu-seconds, and {:.1f} for the check\n{}\n",
      out.string(), render::describe_bytes(baked.store->bytes()), bytes_per_triangle, baked.store->sample_count(),
      baked.grids, 100.0 * static_cast<double>(baked.seen_triangles) / triangles, triangles, baked.cpu_seconds,
      baked.check_cpu_seconds, light::description_of(*baked.store));
  if (options.json.empty()) return Done{};
  nlohmann::json values = {{"bytes", baked.store->bytes()},
                           {"bytes_per_triangle", bytes_per_triangle},
                           {"samples", baked.store->sample_count()},
                           {"grids", baked.grids},
                           {"separate_samples", baked.separate_samples},
                           {"hidden_vertices", baked.hidden_vertices},
                           {"seen_triangles", baked.seen_triangles},
                           {"cpu_s", baked.cpu_seconds},
                           {"check_cpu_s", baked.check_cpu_seconds},
                           {"standard_error", json_of(baked.store->relative_errors())}};
  for (const light_baking::BakeStage& stage : baked.stages) values["stages_cpu_s"][stage.name] = stage.cpu_seconds;
  if (const light::LightCheck& check = baked.store->check; check.eyes > 0) values["check"] = json_of(check);
  return write_json(options.json, values);
}

}  // namespace

RenderCommand add_light_command(CLI::App* program) {
  CLI::App* const parser =
      program->add_subcommand("light", "Compute the light on a scene's surfaces, so that pictures need eye rays alone");
  const auto options = std::make_shared<LightOptions>();
  add_scene_options(parser, &options->scene);
  parser->add_flag(
      "--if-needed", options->if_needed,
      "Compute nothing if the file has the light of this scene; one that is damaged, old or of another scene "
      "is made anew");
  light_baking::BakeSettings& settings = options->settings;
  parser->add_option("--out", options->out, "The file to write; default: light.store in the scene's folder");
  parser->add_option("--eyes", settings.eyes, "Places in the walkable area from which surfaces are looked at")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  parser->add_option("--pixels-per-degree", settings.pixels_per_degree, "Resolution of the wall that shows the scene")
      ->check(CLI::Range(1.0, 1000.0))
      ->capture_default_str();
  parser->add_option("--pixels-per-sample", settings.pixels_per_sample, "Spacing of the finest samples, in pixels")
      ->check(CLI::Range(0.25, 64.0))
      ->capture_default_str();
  parser->add_option("--rays", settings.final_rays, "Scattered rays of each sample; rounded down to a power of two")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  parser->add_option("--light-rays", settings.max_light_rays, "Upper bound of a sample's shadow rays")
      ->check(CLI::Range(16, 65536))
      ->capture_default_str();
  parser
      ->add_option("--probe-error", settings.probe_error,
                   "Relative error between vertices above which a triangle is sampled more finely")
      ->check(CLI::Range(0.001, 10.0))
      ->capture_default_str();
  parser->add_option("--max-parts", settings.max_parts, "Upper bound of samples along a triangle's edge")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  parser
      ->add_option("--bytes-per-triangle", settings.bytes_per_triangle,
                   "Budget for all samples, of which finer ones get what is left, where they mend most")
      ->check(CLI::Range(0.0, 4096.0))
      ->capture_default_str();
  parser
      ->add_option("--max-cpu-seconds", settings.max_cpu_seconds,
                   "Processor seconds after which no finer samples are begun; 0: no limit")
      ->check(CLI::Range(0.0, 1e7))
      ->capture_default_str();
  parser
      ->add_option("--check-eyes", settings.check_eyes,
                   "Held-out eyes from which the result is compared with path tracing; 0: none")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
  parser->add_option("--seed", settings.seed, "Seed of the random numbers")->capture_default_str();
  parser->add_option("--json", options->json, "Also write the figures as JSON");
  return {parser, [options](const StopSignal& stop) { return compute_light(*options, stop); }};
}

}  // namespace cyclorama::tools
