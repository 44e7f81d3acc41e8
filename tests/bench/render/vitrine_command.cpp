// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/vitrine_command.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "renderfarm/light_baking/bake_light.h"
#include "renderfarm/scene/thin_glass.h"
#include "tests/data_sets/vitrine.h"

namespace cyclorama {
namespace {

constexpr int kSidePx = 32;
constexpr int kBounces = 6;
constexpr int kPictures = 8;  ///< Pictures of different seeds, whose differences tell the error.

struct VitrineOptions {
  int samples = 4;
  int reference_samples = 2048;
  int threads = 0;
  std::string json;
};

struct Brightness {
  double mean = 0.0;
  double standard_error = 0.0;
  double cpu_seconds = 0.0;
};

Brightness brightness_of(const render::Renderer& renderer, int samples, bool stored_light) {
  Brightness found;
  double squares = 0.0;
  for (int i = 0; i < kPictures; ++i) {
    render::PanoramaView view = view_into_vitrine(kSidePx, samples, kBounces, static_cast<std::uint64_t>(i + 1));
    view.quality.stored_light = stored_light;
    RadianceImage image;
    found.cpu_seconds += renderer.render_radiance(view, whole(view), &image, nullptr).cpu_seconds;
    const double mean = mean_of(image);
    found.mean += mean / kPictures;
    squares += mean * mean / kPictures;
  }
  found.standard_error = std::sqrt(std::max(0.0, squares - found.mean * found.mean) / (kPictures - 1));
  return found;
}

Status measure(const VitrineOptions& options, const StopSignal& stop) {
  nlohmann::json each = nlohmann::json::array();
  double worst = 0.0;
  fmt::print("{:<18}{:<34}{:>10}{:>12}{:>10}\n", "light", "picture", "darker", "std. error", "cpu-s");
  for (const VitrineLight light : kVitrineLights) {
    scene::Scene solid = vitrine(light);
    scene::Scene thin = solid;
    scene::make_plates_thin(&thin.model);
    TRY_ASSIGN(const std::unique_ptr<render::Renderer> reference,
               render::Renderer::build(std::move(solid), options.threads, nullptr));
    TRY_ASSIGN(const std::unique_ptr<render::Renderer> renderer,
               render::Renderer::build(std::move(thin), options.threads, nullptr));
    const Brightness truth = brightness_of(*reference, options.reference_samples, false);
    const auto tell = [&](const std::string& picture, const Brightness& found) {
      const double darker = 1.0 - found.mean / truth.mean;
      const double error =
          std::hypot(found.standard_error / truth.mean, truth.standard_error * found.mean / (truth.mean * truth.mean));
      fmt::print("{:<18}{:<34}{:>8.2f} %{:>10.2f} %{:>10.2f}\n", name_of(light), picture, 100.0 * darker, 100.0 * error,
                 found.cpu_seconds);
      each.push_back({{"light", name_of(light)}, {"picture", picture}, {"darkening", darker}, {"error", error}});
      return darker;
    };
    tell(fmt::format("bodies, {} samples (reference)", kPictures * options.reference_samples), truth);
    const std::string samples = fmt::format("{} samples", kPictures * options.samples);
    tell("bodies, " + samples, brightness_of(*reference, options.samples, false));
    worst = std::max(worst, tell("thin plates, " + samples, brightness_of(*renderer, options.samples, false)));
    light_baking::BakeSettings settings;
    settings.check_eyes = 0;
    TRY_ASSIGN(
        const light_baking::BakedLight baked,
        light_baking::bake_light(*renderer, settings, options.threads, nullptr, [&] { return stop.requested(); }));
    worst = std::max(worst, tell("stored light, " + samples, brightness_of(*renderer, options.samples, true)));
    if (stop.requested()) return tools::stopped();
  }
  if (options.json.empty()) return Done{};
  return tools::write_json(options.json, {{"darkening", worst}, {"each", each}});
}

}  // namespace

tools::RenderCommand add_vitrine_command(CLI::App* program) {
  CLI::App* const parser = program->add_subcommand(
      "vitrine", "How much darker an object in a display case is than many paths through the glass show it");
  const auto options = std::make_shared<VitrineOptions>();
  parser->add_option("--samples", options->samples, "Samples per pixel of each of 8 pictures")->capture_default_str();
  parser->add_option("--reference-samples", options->reference_samples, "The same of the reference")
      ->capture_default_str();
  parser->add_option("--threads", options->threads, "0: all")->capture_default_str();
  parser->add_option("--json", options->json, "Also write the figures as JSON");
  return {parser, [options](const StopSignal& stop) { return measure(*options, stop); }};
}

}  // namespace cyclorama
