// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/features_command.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "renderfarm/render/requirements.h"
#include "renderfarm/tools/view_options.h"
#include "tests/bench/render/features/feature_saving.h"
#include "tests/bench/render/features/instruction_counter.h"

namespace cyclorama {
namespace {

struct FeaturesOptions {
  std::vector<std::string> scenes;
  std::string json;
  tools::ViewOptions view;
  render::RenderQuality quality;
  int repetitions = 9;
};

/// Returns the folder's or file's name without its extension.
std::string name_of(const std::string& scene) {
  const std::filesystem::path path = std::filesystem::path(scene).lexically_normal();
  return (path.has_filename() ? path : path.parent_path()).stem().string();
}

std::string number_or_none(const std::optional<double>& value, double factor) {
  return value ? fmt::format("{:.1f}", factor * *value) : "-";
}

void print_row(std::string_view what, const KernelCost& cost, const FeatureSaving* saved) {
  fmt::print("  {:<28}{:>10.1f}{:>14}", what, cost.ns_per_ray, number_or_none(cost.instructions_per_ray, 1.0));
  if (saved != nullptr) {
    fmt::print("{:>12.1f}{:>18}", 1e2 * saved->time_saving, number_or_none(saved->instruction_saving, 1e2));
  }
  fmt::print("\n");
}

void print(const std::string& name, const FeatureReport& report) {
  fmt::print("{}: {}, {} rays\n", name, render::describe(report.kernel), report.rays);
  fmt::print("  {:<28}{:>10}{:>14}{:>12}{:>18}\n", "kernel", "ns/ray", "instr./ray", "% of time", "% of instructions");
  print_row("its own", report.cost, nullptr);
  for (const FeatureSaving& saved : report.savings) print_row(render::describe(saved.kernel), saved.cost, &saved);
}

nlohmann::json json_of(const std::optional<double>& value) { return value ? nlohmann::json(*value) : nlohmann::json(); }

nlohmann::json json_of(const FeatureSaving& saved) {
  return {{"kernel", static_cast<int>(saved.kernel)},
          {"ns_per_ray", saved.cost.ns_per_ray},
          {"instructions_per_ray", json_of(saved.cost.instructions_per_ray)},
          {"time_saving", saved.time_saving},
          {"instruction_saving", json_of(saved.instruction_saving)}};
}

nlohmann::json json_of(const FeatureReport& report) {
  nlohmann::json features = nlohmann::json::object();
  for (const FeatureSaving& saved : report.savings)
    features[std::string(render::describe(saved.kernel))] = json_of(saved);
  return {{"kernel", static_cast<int>(report.kernel)},
          {"rays", report.rays},
          {"ns_per_ray", report.cost.ns_per_ray},
          {"instructions_per_ray", json_of(report.cost.instructions_per_ray)},
          {"features", features}};
}

Status features(const FeaturesOptions& options, const StopSignal& stop) {
  if (const auto counter = InstructionCounter::open(); !counter) {
    fmt::print(stderr, "no processor counter on this machine, so instructions are left out: {}\n",
               counter.error().message());
  }
  nlohmann::json all = nlohmann::json::object();
  for (const std::string& path : options.scenes) {
    const tools::SceneOptions scene{path, 1, ""};
    TRY_ASSIGN(tools::LoadedScene loaded, tools::load_with_progress(scene));
    TRY_ASSIGN(render::PanoramaView view, tools::panorama_view_of(options.view, loaded.scene.info));
    view.quality = options.quality;
    TRY(render::check_view(view, {}));
    if (stop.requested()) return tools::stopped();
    TRY_ASSIGN(const std::unique_ptr<render::Renderer> renderer,
               tools::build_with_progress(std::move(loaded.scene), scene));
    TRY_ASSIGN(const FeatureReport report,
               measure_features(renderer.get(), view, options.repetitions, [&] { return stop.requested(); }));
    print(name_of(path), report);
    all[name_of(path)] = json_of(report);
  }
  if (options.json.empty()) return Done{};
  return tools::write_json(options.json, all);
}

}  // namespace

tools::RenderCommand add_features_command(CLI::App* program) {
  CLI::App* const parser =
      program->add_subcommand("features", "Measure what scenes save by kernels without what they do not need");
  const auto options = std::make_shared<FeaturesOptions>();
  options->view.size = "320x120";
  options->quality.samples = 4;
  options->quality.bounces = scene::kUsualBounces;
  parser->add_option("scenes", options->scenes, "Scene packages, or .glb, .gltf, .ply or .obj files")->required();
  tools::add_view_options(parser, &options->view);
  parser->add_option("--samples", options->quality.samples, "Samples per pixel")->capture_default_str();
  parser->add_option("--bounces", options->quality.bounces, "Times that light goes from surface to surface")
      ->capture_default_str();
  parser->add_option("--repetitions", options->repetitions, "Of every kernel, in turns; the median counts")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  parser->add_option("--json", options->json, "Also write the figures as JSON");
  return {parser, [options](const StopSignal& stop) { return features(*options, stop); }};
}

}  // namespace cyclorama
