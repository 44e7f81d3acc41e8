// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/light_leaks_command.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "renderfarm/light_baking/bake_light.h"
#include "tests/data_sets/leak_cases.h"

namespace cyclorama {
namespace {

struct LeakOptions {
  int parts = 8;
  int width = 256;
  int height = 128;
  int reference_samples = 512;
  int threads = 0;
  std::string only;  ///< A part of a case's name; empty: all cases.
  std::int64_t min_rays = light_baking::BakeSettings().min_rays;
  std::string json;
};

Status measure(const LeakOptions& options, const StopSignal& stop) {
  light_baking::BakeSettings settings;
  settings.pixels_per_degree = 4.0;  // Still several times that of the pictures.
  settings.check_eyes = 0;           // These pictures are its check.
  settings.min_rays = options.min_rays;
  int cases = 0;
  int blocks = 0;
  int bad_blocks = 0;
  double worst_codes = 0.0;
  nlohmann::json each = nlohmann::json::array();
  fmt::print("{:<42}{:>8}{:>12}{:>13}{:>10}{:>12}\n", "case", "blocks", "off by > 4", "worst codes", "bias",
             "bake cpu-s");
  for (LeakCase& leak : leak_cases(options.parts)) {
    if (std::string_view(leak.name).find(options.only) == std::string_view::npos) continue;
    TRY_ASSIGN(const std::unique_ptr<render::Renderer> renderer,
               render::Renderer::build(std::move(leak.scene), options.threads, nullptr));
    TRY_ASSIGN(
        const light_baking::BakedLight baked,
        light_baking::bake_light(*renderer, settings, options.threads, nullptr, [&] { return stop.requested(); }));
    const LightDifference found = light_difference(
        *renderer, view_from(leak.eye, options.width, options.height, 1.5, -1.5), options.reference_samples);
    if (stop.requested()) return tools::stopped();
    fmt::print("{:<42}{:>8}{:>12}{:>13.2f}{:>8.2f} %{:>12.1f}\n", leak.name, found.blocks, found.bad_blocks,
               found.worst_codes, 100.0 * found.relative_bias, baked.cpu_seconds);
    ++cases;
    bad_blocks += found.bad_blocks;
    blocks += found.blocks;
    worst_codes = std::max(worst_codes, found.worst_codes);
    each.push_back({{"case", leak.name},
                    {"blocks_beyond_4_codes", found.bad_blocks},
                    {"worst_codes", found.worst_codes},
                    {"bias", found.relative_bias}});
  }
  fmt::print("{} cases: {} of {} blocks are off by more than 4 codes, the worst by {:.2f}\n", cases, bad_blocks, blocks,
             worst_codes);
  if (options.json.empty()) return Done{};
  return tools::write_json(options.json,
                           {{"cases", cases}, {"blocks", bad_blocks}, {"worst_codes", worst_codes}, {"each", each}});
}

}  // namespace

tools::RenderCommand add_light_leaks_command(CLI::App* program) {
  CLI::App* const parser = program->add_subcommand(
      "light-leaks", "Blocks of pictures into which stored light leaks, or from which it is gone");
  const auto options = std::make_shared<LeakOptions>();
  parser->add_option("--parts", options->parts, "Squares along an edge of the rooms")->capture_default_str();
  parser->add_option("--width", options->width, "Pictures' width in pixels")->capture_default_str();
  parser->add_option("--height", options->height, "Pictures' height in pixels")->capture_default_str();
  parser->add_option("--reference-samples", options->reference_samples, "Samples of the reference")
      ->capture_default_str();
  parser->add_option("--threads", options->threads, "0: all")->capture_default_str();
  parser->add_option("--only", options->only, "Only the cases with this in their name");
  parser->add_option("--min-rays", options->min_rays, "Lower bound of the rays of all samples together")
      ->capture_default_str();
  parser->add_option("--json", options->json, "Also write the figures as JSON");
  return {parser, [options](const StopSignal& stop) { return measure(*options, stop); }};
}

}  // namespace cyclorama
