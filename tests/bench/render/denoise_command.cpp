// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/denoise_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <vector>

#include "common/base/cpu_time.h"
#include "renderfarm/denoise/denoise.h"
#include "renderfarm/denoise/gain.h"

namespace cyclorama {
namespace {

constexpr int kSamples[] = {1, 2, 4, 8, 16};
constexpr std::uint64_t kReferenceSeed = 1'000'000;  ///< Differs from the films' seeds.

struct DenoiseOptions {
  tools::SceneOptions scene;
  std::string json;
  int width = 384;
  int height = 192;
  double azimuth_deg = 90.0;
  int films = 4;
  int reference_samples = 1024;
  std::optional<int> bounces;
};

render::PanoramaView view_of(const DenoiseOptions& options, const scene::Scene& scene) {
  render::PanoramaView view;
  view.eye = scene.info.start_eye;
  view.heading_rad = scene.info.start_heading_rad;
  const double span = options.azimuth_deg * std::numbers::pi / 180.0;
  const double tan_half = 0.5 * span * options.height / options.width;
  view.panorama = {options.width, options.height, span, tan_half, -tan_half};
  view.quality.bounces = options.bounces.value_or(scene.bounces);
  return view;
}

/// One line of the table.
struct Line {
  int samples = 0;
  denoise::DenoiseGain gain;
  double render_s = 0.0;   ///< Per film, without features.
  double feature_s = 0.0;  ///< Additional time with features.
  double denoise_s = 0.0;

  /// Compared with a film that spends the time of features and filter on more samples; its error falls as its time
  /// grows.
  [[nodiscard]] double gain_at_equal_time() const {
    return gain.gain() * render_s / (render_s + feature_s + denoise_s);
  }
};

class Measurement {
 public:
  Measurement(const render::Renderer& renderer, const DenoiseOptions& options, const StopSignal& stop)
      : renderer_(renderer),
        view_(view_of(options, renderer.scene())),
        whole_{0, 0, options.width, options.height},
        films_(options.films),
        stop_(stop) {}

  RadianceImage reference(int samples) {
    view_.seed = kReferenceSeed;
    view_.quality.samples = samples;
    RadianceImage picture;
    renderer_.render_radiance(view_, whole_, &picture, cancelled());
    return picture;
  }

  Result<Line> line(int samples, const RadianceImage& reference) {
    Line line;
    line.samples = samples;
    std::vector<render::Film> films(static_cast<std::size_t>(films_));
    view_.quality.samples = samples;
    for (std::size_t i = 0; i < films.size(); ++i) {
      view_.seed = i;
      render::Film plain;
      const double without = renderer_.render_film(view_, whole_, false, &plain, cancelled()).cpu_seconds;
      const double with = renderer_.render_film(view_, whole_, true, &films[i], cancelled()).cpu_seconds;
      line.render_s += without / films_;
      line.feature_s += std::max(0.0, with - without) / films_;
    }
    if (stop_.requested()) return tools::stopped();
    const denoise::PixelRays rays = denoise::panorama_rays(view_.panorama, view_.heading_rad, whole_);
    denoise::Denoiser denoiser;
    RadianceImage picture(whole_.width, whole_.height);
    TRY_ASSIGN(line.gain, denoise::measure_gain(reference, films, [&](const render::Film& film) {
                 const double start = thread_cpu_seconds();
                 denoiser.denoise(film, rays, whole_, &picture);
                 // The last repetition, when the denoiser has allocated its memory.
                 line.denoise_s = thread_cpu_seconds() - start;
                 return picture;
               }));
    return line;
  }

 private:
  [[nodiscard]] std::function<bool()> cancelled() const {
    return [this] { return stop_.requested(); };
  }

  const render::Renderer& renderer_;
  render::PanoramaView view_;
  PixelRect whole_;
  int films_;
  const StopSignal& stop_;
};

nlohmann::json json_of(const Line& line) {
  return {{"samples", line.samples},
          {"relmse_before", line.gain.mse_before},
          {"relmse_after", line.gain.mse_after},
          {"gain", line.gain.gain()},
          {"bias2", line.gain.bias2},
          {"bias_share", line.gain.bias_share()},
          {"variance_after", line.gain.variance_after},
          {"render_s", line.render_s},
          {"feature_s", line.feature_s},
          {"denoise_s", line.denoise_s},
          {"gain_at_equal_time", line.gain_at_equal_time()}};
}

Status run_denoise(const DenoiseOptions& options, const StopSignal& stop) {
  TRY_ASSIGN(tools::LoadedScene loaded, tools::load_with_progress(options.scene));
  TRY(render::check_view(view_of(options, loaded.scene), {}));
  if (stop.requested()) return tools::stopped();
  TRY_ASSIGN(const std::unique_ptr<render::Renderer> renderer,
             tools::build_with_progress(std::move(loaded.scene), options.scene));
  Measurement measurement(*renderer, options, stop);
  const RadianceImage reference = measurement.reference(options.reference_samples);
  if (stop.requested()) return tools::stopped();
  const double megapixels = 1e-6 * options.width * options.height;
  nlohmann::json lines = nlohmann::json::array();
  fmt::print("relMSE of {} films of {}x{}, reference of {} samples; times in cpu-seconds\n", options.films,
             options.width, options.height, options.reference_samples);
  fmt::print("samples    before     after    gain  bias share  render ms/Mpx  features  denoise  gain at equal time\n");
  for (const int samples : kSamples) {
    TRY_ASSIGN(const Line line, measurement.line(samples, reference));
    const double ms = 1e3 / megapixels;
    fmt::print("{:7} {:9.3g} {:9.3g} {:7.2f} {:11.2f} {:14.1f} {:9.1f} {:8.1f} {:10.2f}{}\n", line.samples,
               line.gain.mse_before, line.gain.mse_after, line.gain.gain(), line.gain.bias_share(), ms * line.render_s,
               ms * line.feature_s, ms * line.denoise_s, line.gain_at_equal_time(),
               line.gain_at_equal_time() > 1.0 ? "" : "  does not pay");
    lines.push_back(json_of(line));
  }
  if (options.json.empty()) return Done{};
  return tools::write_json(options.json, {{"halo_px", denoise::Denoiser::halo_px()}, {"points", lines}});
}

}  // namespace

tools::RenderCommand add_denoise_command(CLI::App* program) {
  CLI::App* const parser = program->add_subcommand("denoise", "Measure what the denoiser wins, and its bias");
  const auto options = std::make_shared<DenoiseOptions>();
  tools::add_scene_options(parser, &options->scene);
  parser->add_option("--width", options->width, "Of the panorama from the scene's start, pixels")
      ->capture_default_str();
  parser->add_option("--height", options->height, "Of the same, pixels")->capture_default_str();
  parser->add_option("--azimuth-deg", options->azimuth_deg, "Its width, degrees")->capture_default_str();
  parser
      ->add_option("--bounces", options->bounces,
                   "Times that light goes from surface to surface; the scene's if left out")
      ->check(CLI::Range(0, render::kMaxBounces));
  parser->add_option("--films", options->films, "Of other seeds, for each number of samples")
      ->check(CLI::Range(2, 64))
      ->capture_default_str();
  parser->add_option("--reference-samples", options->reference_samples, "Samples per pixel of the reference")
      ->check(CLI::Range(1, render::kMaxSamples))
      ->capture_default_str();
  parser->add_option("--json", options->json, "Also write the figures as JSON");
  return {parser, [options](const StopSignal& stop) { return run_denoise(*options, stop); }};
}

}  // namespace cyclorama
