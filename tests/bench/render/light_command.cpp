// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/light_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/process/progress.h"
#include "renderfarm/denoise/denoising_renderer.h"
#include "renderfarm/light_baking/bake_light.h"
#include "renderfarm/light_baking/check_light.h"
#include "renderfarm/quality/flip.h"
#include "renderfarm/quality/split_reference.h"
#include "renderfarm/render/tone.h"

namespace cyclorama {
namespace {

struct LightOptions {
  tools::SceneOptions scene;
  light_baking::BakeSettings bake;
  int eyes = 8;
  int width = 480;
  int height = 180;
  int reference_samples = 256;
  std::vector<double> curve{};  ///< Budgets in bytes per triangle to be compared; empty: the bake's own alone.
  std::string json;
};

enum class Method { kStored, kDenoised, kPaths };

/// One kind of picture, measured over all eyes.
struct Line {
  Method method = Method::kPaths;
  int samples = 1;
  double cpu_s_per_mpx = 0.0;
  double relmse = 0.0;
  double flip = 0.0;
  std::vector<double> block_relmse{};  ///< One per eye.
  double bias = 0.0;                   ///< Relative error of the picture's mean.

  [[nodiscard]] std::string name() const {
    const char* const names[] = {"stored light", "denoised", "paths"};
    return fmt::format("{}, {} samples", names[static_cast<int>(method)], samples);
  }
};

/// A reference with the mean of its halves.
struct Reference {
  quality::SplitReference halves;
  RadianceImage mean;
};

class Measurement {
 public:
  Measurement(const LightOptions& options, const StopSignal& stop, render::Renderer& renderer)
      : options_(options), stop_(stop), renderer_(renderer), denoising_(renderer) {}

  /// Measures all lines from all eyes. Further calls use the references of the first.
  Status run(std::vector<Line>* lines) {
    const scene::SceneInfo& info = renderer_.scene().info;
    const std::vector<Eigen::Vector3d> eyes = light_baking::held_out_eyes(info, options_.eyes);
    Progress progress("comparing");
    for (std::size_t i = 0; i < eyes.size(); ++i) {
      view_ = light_baking::held_out_view(info, eyes[i], static_cast<int>(i), options_.width, options_.height);
      if (i == references_.size()) {
        TRY_ASSIGN(Reference reference, make_reference());
        references_.push_back(std::move(reference));
      }
      for (Line& line : *lines) {
        TRY(measure(references_[i], 1.0 / static_cast<double>(eyes.size()), &line));
      }
      progress.update(static_cast<double>(i + 1) / static_cast<double>(eyes.size()));
    }
    return Done{};
  }

 private:
  [[nodiscard]] PixelRect whole() const { return {0, 0, options_.width, options_.height}; }

  Result<Reference> make_reference() {
    Reference reference;
    for (RadianceImage* const half : {&reference.halves.a, &reference.halves.b}) {
      view_.seed = half == &reference.halves.a ? 1'000'001 : 1'000'002;
      view_.quality = {};
      view_.quality.samples = options_.reference_samples;
      view_.quality.bounces = renderer_.scene().bounces;
      renderer_.render_radiance(view_, whole(), half, [this] { return stop_.requested(); });
      if (stop_.requested()) return tools::stopped();
    }
    reference.mean = quality::mean_of(reference.halves);
    return reference;
  }

  Status measure(const Reference& reference, double share, Line* line) {
    view_.seed = 1;
    view_.quality = {};
    view_.quality.samples = line->samples;
    view_.quality.bounces = renderer_.scene().bounces;
    view_.quality.stored_light = line->method == Method::kStored;
    RadianceImage picture;
    const auto cancelled = [this] { return stop_.requested(); };
    const render::RenderCost cost = line->method == Method::kDenoised
                                        ? denoising_.render_radiance(view_, whole(), &picture, cancelled)
                                        : renderer_.render_radiance(view_, whole(), &picture, cancelled);
    if (stop_.requested()) return tools::stopped();
    line->cpu_s_per_mpx += share * cost.cpu_seconds / (1e-6 * static_cast<double>(whole().area()));
    line->relmse += share * quality::unbiased_relmse(picture, reference.halves);
    line->block_relmse.push_back(
        quality::unbiased_relmse(quality::block_means(picture, light_baking::kCheckedBlockPx),
                                 quality::block_means(reference.halves, light_baking::kCheckedBlockPx)));
    line->bias += share * (quality::mean_value(picture) / quality::mean_value(reference.mean) - 1.0);
    const scene::ToneCurve tone = renderer_.scene().tone;
    TRY_ASSIGN(const quality::Flip flip,
               quality::flip(render::developed(picture, tone), render::developed(reference.mean, tone)));
    line->flip += share * flip.mean;
    return Done{};
  }

  const LightOptions& options_;
  const StopSignal& stop_;
  render::Renderer& renderer_;
  denoise::DenoisingRenderer denoising_;
  render::PanoramaView view_;
  std::vector<Reference> references_;  ///< One per eye.
};

/// Returns what a method costs at an error, from its measured lines: a power law through the two that are nearest.
double cost_at(const std::vector<Line>& lines, Method method, double relmse) {
  std::vector<const Line*> own;
  for (const Line& line : lines) {
    if (line.method == method) own.push_back(&line);
  }
  std::ranges::sort(own, {}, [](const Line* line) { return line->relmse; });
  const Line* a = own[0];
  const Line* b = own[1];
  for (std::size_t i = 1; i + 1 < own.size() && own[i]->relmse < relmse; ++i) a = own[i], b = own[i + 1];
  const double slope = std::log(b->cpu_s_per_mpx / a->cpu_s_per_mpx) / std::log(b->relmse / a->relmse);
  return a->cpu_s_per_mpx * std::pow(relmse / a->relmse, slope);
}

Result<light_baking::BakedLight> bake(const LightOptions& options, const light_baking::BakeSettings& settings,
                                      const StopSignal& stop, render::Renderer& renderer) {
  Progress progress("computing light");
  return light_baking::bake_light(
      renderer, settings, options.scene.threads, [&](double fraction) { progress.update(fraction); },
      [&] { return stop.requested(); });
}

/// The cost of light.
struct BakeFigures {
  double bytes_per_triangle = 0.0;
  double cpu_s = 0.0;
  double cpu_s_per_million_seen = 0.0;

  BakeFigures(const light_baking::BakedLight& baked, const render::Renderer& renderer)
      : bytes_per_triangle(static_cast<double>(baked.store->bytes()) /
                           static_cast<double>(renderer.scene().triangles_seen())),
        cpu_s(baked.cpu_seconds),
        cpu_s_per_million_seen(1e6 * baked.cpu_seconds / static_cast<double>(baked.seen_triangles)) {}
};

double mean_block_relmse(const Line& line) {
  double mean = 0.0;
  for (const double block : line.block_relmse) mean += block / static_cast<double>(line.block_relmse.size());
  return mean;
}

/// Prints the error of pictures for each budget of bytes.
Status measure_curve(const LightOptions& options, const StopSignal& stop, render::Renderer& renderer,
                     Measurement& measurement) {
  fmt::print("{:>15}{:>15}{:>12}{:>13}{:>14}{:>12}{:>9}\n", "budget", "bytes/triangle", "bake cpu-s", "relMSE at 4",
             "relMSE at 16", "8x8 relMSE", "FLIP");
  nlohmann::json rows = nlohmann::json::array();
  for (const double budget : options.curve) {
    light_baking::BakeSettings settings = options.bake;
    settings.bytes_per_triangle = budget;
    settings.min_bytes = 0;
    TRY_ASSIGN(const light_baking::BakedLight baked, bake(options, settings, stop, renderer));
    std::vector<Line> lines = {{Method::kStored, 4}, {Method::kStored, 16}};
    TRY(measurement.run(&lines));
    const BakeFigures figures(baked, renderer);
    fmt::print("{:>15.1f}{:>15.1f}{:>12.1f}{:>13.5f}{:>14.5f}{:>12.2e}{:>9.4f}\n", budget, figures.bytes_per_triangle,
               figures.cpu_s, lines[0].relmse, lines[1].relmse, mean_block_relmse(lines[1]), lines[1].flip);
    rows.push_back({{"budget_bytes_per_triangle", budget},
                    {"bytes_per_triangle", figures.bytes_per_triangle},
                    {"bake_cpu_s", figures.cpu_s},
                    {"relmse_4_samples", lines[0].relmse},
                    {"relmse_16_samples", lines[1].relmse},
                    {"cpu_s_per_mpx_4_samples", lines[0].cpu_s_per_mpx},
                    {"block_relmse", mean_block_relmse(lines[1])},
                    {"flip", lines[1].flip}});
  }
  if (options.json.empty()) return Done{};
  return tools::write_json(options.json, {{"curve", rows}});
}

Status measure_ratios(const LightOptions& options, const StopSignal& stop, render::Renderer& renderer,
                      Measurement& measurement) {
  TRY_ASSIGN(const light_baking::BakedLight baked, bake(options, options.bake, stop, renderer));
  std::vector<Line> lines = {{Method::kStored, 1},   {Method::kStored, 4},    {Method::kStored, 16},
                             {Method::kDenoised, 4}, {Method::kDenoised, 16}, {Method::kPaths, 4},
                             {Method::kPaths, 16}};
  TRY(measurement.run(&lines));
  const BakeFigures figures(baked, renderer);
  fmt::print("light: {:.1f} cpu-seconds, {:.1f} per million seen triangles; {:.1f} bytes per triangle\n", figures.cpu_s,
             figures.cpu_s_per_million_seen, figures.bytes_per_triangle);
  fmt::print("{:<26}{:>12}{:>11}{:>9}{:>12}{:>12}{:>9}\n", "picture", "cpu-s/Mpx", "relMSE", "FLIP", "8x8 relMSE",
             "worst eye", "bias");
  for (const Line& line : lines) {
    fmt::print("{:<26}{:>12.3f}{:>11.5f}{:>9.4f}{:>12.2e}{:>12.2e}{:>8.2f}%\n", line.name(), line.cpu_s_per_mpx,
               line.relmse, line.flip, mean_block_relmse(line), *std::ranges::max_element(line.block_relmse),
               100.0 * line.bias);
  }
  const Line& best = lines[1];
  const double ratio_denoised = cost_at(lines, Method::kDenoised, best.relmse) / best.cpu_s_per_mpx;
  const double ratio_paths = cost_at(lines, Method::kPaths, best.relmse) / best.cpu_s_per_mpx;
  fmt::print("at the error of '{}': denoised pictures cost {:.1f} times as much, paths {:.0f} times\n", best.name(),
             ratio_denoised, ratio_paths);
  if (options.json.empty()) return Done{};
  return tools::write_json(options.json, {{"ratio_denoised", ratio_denoised},
                                          {"ratio_paths", ratio_paths},
                                          {"relmse", best.relmse},
                                          {"flip", best.flip},
                                          {"block_relmse_worst_eye", *std::ranges::max_element(best.block_relmse)},
                                          {"bias", best.bias},
                                          {"cpu_s_per_mpx", best.cpu_s_per_mpx},
                                          {"cpu_s_per_mpx_one_sample", lines[0].cpu_s_per_mpx},
                                          {"relmse_one_sample", lines[0].relmse},
                                          {"bytes_per_triangle", figures.bytes_per_triangle},
                                          {"bake_cpu_s", figures.cpu_s},
                                          {"bake_cpu_s_per_million_seen", figures.cpu_s_per_million_seen}});
}

Status measure_light(const LightOptions& options, const StopSignal& stop) {
  TRY_ASSIGN(tools::LoadedScene loaded, tools::load_with_progress(options.scene));
  TRY_ASSIGN(const std::unique_ptr<render::Renderer> renderer,
             tools::build_with_progress(std::move(loaded.scene), options.scene));
  Measurement measurement(options, stop, *renderer);
  return options.curve.empty() ? measure_ratios(options, stop, *renderer, measurement)
                               : measure_curve(options, stop, *renderer, measurement);
}

}  // namespace

tools::RenderCommand add_light_command(CLI::App* program) {
  CLI::App* const parser =
      program->add_subcommand("light", "Compare pictures that read stored light with path tracing at equal error");
  const auto options = std::make_shared<LightOptions>();
  options->bake.check_eyes = 0;  // This command has references of its own.
  tools::add_scene_options(parser, &options->scene);
  parser->add_option("--eyes", options->eyes, "Held-out eyes, at random places of the walkable area")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  parser->add_option("--width", options->width, "Pictures' width in pixels")->capture_default_str();
  parser->add_option("--height", options->height, "Pictures' height in pixels")->capture_default_str();
  parser->add_option("--reference-samples", options->reference_samples, "Samples of each half of the reference")
      ->capture_default_str();
  parser->add_option("--probe-error", options->bake.probe_error, "As cyclorama-render light")->capture_default_str();
  parser->add_option("--max-parts", options->bake.max_parts, "As cyclorama-render light; a power of two")
      ->capture_default_str();
  parser->add_option("--bytes-per-triangle", options->bake.bytes_per_triangle, "As cyclorama-render light")
      ->capture_default_str();
  parser->add_option("--min-bytes", options->bake.min_bytes, "Least budget for all samples, in bytes")
      ->capture_default_str();
  parser->add_option("--curve", options->curve, "Compare these budgets in bytes per triangle, such as 8,12,24")
      ->delimiter(',');
  parser->add_option("--rays", options->bake.final_rays, "As cyclorama-render light; a power of two")
      ->capture_default_str();
  parser->add_option("--json", options->json, "Also write the figures as JSON");
  return {parser, [options](const StopSignal& stop) { return measure_light(*options, stop); }};
}

}  // namespace cyclorama
