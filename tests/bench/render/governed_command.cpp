// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/governed_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>
#include <vector>

#include "common/base/clock.h"
#include "common/base/percentiles.h"
#include "common/process/progress.h"
#include "renderfarm/denoise/denoising_renderer.h"
#include "renderfarm/governor/governor.h"
#include "renderfarm/governor/pareto_front_file.h"
#include "renderfarm/quality/light_error.h"
#include "renderfarm/tools/view_options.h"
#include "tests/bench/render/trade/trade_meter.h"

namespace cyclorama {
namespace {

/// The reference's own noise is part of every error; with this many times the samples it is at most an eighth.
constexpr int kReferencePerStill = 8;

struct GovernedOptions {
  tools::SceneOptions scene;
  tools::ViewOptions view;
  std::vector<double> budgets_ms{10, 20, 33, 50, 100, 1000};
  std::string front;
  std::string json;
  int frames = 60;
  int reference_samples = 2048;
  std::optional<int> reference_bounces;
};

/// Result for one budget after the governor had settled: over the second half of the frames.
struct BudgetResult {
  double budget_ms = 0.0;
  Percentiles frame_ms;
  /// Qualities, and the number of frames with each; rarely more than a few.
  std::vector<std::pair<render::PictureQuality, int>> frames_at;
  double relmse = 0.0, flip = 0.0, bytes = 0.0;  ///< Means over those frames.

  void count(const render::PictureQuality& quality) {
    const auto known = std::ranges::find(frames_at, quality, [](const auto& entry) { return entry.first; });
    if (known == frames_at.end()) {
      frames_at.emplace_back(quality, 1);
    } else {
      ++known->second;
    }
  }
  /// Returns the most frequent one.
  [[nodiscard]] const render::PictureQuality& quality() const {
    return std::ranges::max_element(frames_at, {}, [](const auto& entry) { return entry.second; })->first;
  }
};

struct Still {
  std::vector<int> samples;
  std::vector<double> mse;
  /// Least-squares slope of log(mse) over log(samples).
  [[nodiscard]] double slope() const {
    double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
    for (std::size_t i = 0; i < mse.size(); ++i) {
      const double x = std::log(samples[i]);
      const double y = std::log(mse[i]);
      sx += x, sy += y, sxx += x * x, sxy += x * y;
    }
    const auto n = static_cast<double>(mse.size());
    return (n * sxy - sx * sy) / (n * sxx - sx * sx);
  }
};

PixelRect whole(const Panorama& panorama) { return {0, 0, panorama.width_px, panorama.height_px}; }

/// The farm's steps for a frame on one machine: choose, render, denoise, encode, learn. No network.
class GovernedLoop {
 public:
  GovernedLoop(const render::Renderer& renderer, const GovernedOptions& options, render::PanoramaView view,
               const StopSignal& stop)
      : renderer_(renderer),
        threads_(options.scene.threads > 0 ? options.scene.threads
                                           : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()))),
        denoising_(renderer),
        view_(std::move(view)),
        stop_(stop) {}

  Result<BudgetResult> hold(double budget_ms, const governor::ParetoFront& front, int frames) {
    BudgetResult result;
    result.budget_ms = budget_ms;
    governor::Governor governor(front, budget_ms);
    const double megapixels = 1e-6 * static_cast<double>(whole(view_.panorama).area());
    for (int i = 0; i < frames; ++i) {
      const governor::ParetoPoint point = governor.choose(megapixels);
      const TimePoint start = SteadyClock().now();
      double rays_ms = 0.0;
      TRY(make_frame(point.quality, static_cast<std::uint64_t>(i), &rays_ms));
      const double ms = 1e3 * to_seconds(SteadyClock().now() - start);
      governor.measured({point.cost * megapixels, ms, rays_ms});
      if (2 * i < frames) continue;
      result.frame_ms.add(ms);
      result.count(point.quality);
    }
    return result;
  }

 private:
  /// `rays_ms` is set to the thread time over the threads.
  Status make_frame(const render::PictureQuality& quality, std::uint64_t seed, double* rays_ms) {
    render::PanoramaView view = view_;
    view.panorama = scaled(view.panorama, quality.scale);
    view.quality = quality.render;
    view.seed = seed;
    const auto cancelled = [this] { return stop_.requested(); };
    const PixelRect rect = whole(view.panorama);
    const render::RenderCost cost = quality.denoise ? denoising_.render(view, rect, &picture_, cancelled)
                                                    : renderer_.render(view, rect, &picture_, cancelled);
    *rays_ms = 1e3 * cost.cpu_seconds / threads_;
    if (stop_.requested()) return tools::stopped();
    TRY_ASSIGN([[maybe_unused]] const auto jpeg,
               encoder_.encode(picture_, {quality.jpeg_quality, quality.subsample_chroma}));
    return Done{};
  }

  const render::Renderer& renderer_;
  const int threads_;
  denoise::DenoisingRenderer denoising_;
  const render::PanoramaView view_;
  const StopSignal& stop_;
  JpegEncoder encoder_;
  RgbImage picture_;
};

/// Returns null for a scene that was not measured.
Result<std::optional<governor::ParetoFront>> front_of(const GovernedOptions& options) {
  std::filesystem::path file = options.front;
  if (file.empty()) file = std::filesystem::path(options.scene.scene) / governor::kParetoFrontFileName;
  if (!options.front.empty() || std::filesystem::exists(file)) {
    TRY_ASSIGN(governor::ParetoFront front, governor::read_pareto_front(file));
    return std::optional(std::move(front));
  }
  return std::optional<governor::ParetoFront>();
}

/// Errors of qualities. They do not depend on the budget, so each is measured once.
class PictureErrors {
 public:
  PictureErrors(TradeMeter* meter, const StopSignal& stop) : meter_(*meter), stop_(stop) {}

  Status add_to(BudgetResult* result) {
    int frames = 0;
    for (const auto& [quality, count] : result->frames_at) {
      auto known = std::ranges::find(known_, quality, [](const TradePoint& point) { return point.planned.quality; });
      if (known == known_.end()) {
        TRY_ASSIGN(TradePoint measured, meter_.measure({"governed", quality}, [this] { return stop_.requested(); }));
        known = known_.insert(known_.end(), std::move(measured));
      }
      const TradePoint& error = *known;
      result->relmse += count * error.relmse;
      result->flip += count * error.shown.flip;
      result->bytes += count * static_cast<double>(error.bytes);
      frames += count;
    }
    result->relmse /= frames;
    result->flip /= frames;
    result->bytes /= frames;
    return Done{};
  }

 private:
  TradeMeter& meter_;
  const StopSignal& stop_;
  std::vector<TradePoint> known_;
};

/// Doubles the samples at each step, as a picture at rest is refined.
Result<Still> rest(const render::Renderer& renderer, render::PanoramaView view, int max_samples,
                   const RadianceImage& reference, const StopSignal& stop) {
  Still still;
  render::Film film(reference.width(), reference.height(), false);
  view.quality.sequence = max_samples;
  int have = 0;
  for (int samples = 1; samples <= max_samples; samples *= 2) {
    view.quality.first_sample = have;
    view.quality.samples = samples - have;
    render::Film more;
    renderer.render_film(view, whole(view.panorama), false, &more, [&] { return stop.requested(); });
    if (stop.requested()) return tools::stopped();
    film.add(more);
    have = samples;
    still.samples.push_back(samples);
    TRY_ASSIGN(const double mse, quality::mean_squared_error(film.mean(), reference));
    still.mse.push_back(mse);
  }
  return still;
}

nlohmann::json json_of(const BudgetResult& result) {
  const render::PictureQuality& quality = result.quality();
  return {
      {"budget_ms", result.budget_ms},      {"relmse", result.relmse},           {"flip", result.flip},
      {"bytes", std::lround(result.bytes)}, {"ms_p50", result.frame_ms.at(0.5)}, {"ms_p95", result.frame_ms.at(0.95)},
      {"samples", quality.render.samples},  {"bounces", quality.render.bounces}, {"scale", quality.scale},
      {"denoise", quality.denoise}};
}

void print(const BudgetResult& result) {
  const render::PictureQuality& quality = result.quality();
  fmt::print("{:9.0f} {:7} {:7} {:5.2f} {:>8} {:8.1f} {:8.1f} {:8.4f} {:7.4f} {:8.0f}\n", result.budget_ms,
             quality.render.samples, quality.render.bounces, quality.scale, quality.denoise ? "yes" : "no",
             result.frame_ms.at(0.5), result.frame_ms.at(0.95), result.relmse, result.flip, result.bytes);
}

Status governed(const GovernedOptions& options, const StopSignal& stop) {
  TRY_ASSIGN(const std::optional<governor::ParetoFront> measured, front_of(options));
  TRY_ASSIGN(tools::LoadedScene loaded, tools::load_with_progress(options.scene));
  const governor::ParetoFront front = measured.value_or(governor::ParetoFront::standard(loaded.scene.bounces));
  TRY_ASSIGN(render::PanoramaView view, tools::panorama_view_of(options.view, loaded.scene.info));
  if (stop.requested()) return tools::stopped();
  TRY_ASSIGN(const std::unique_ptr<render::Renderer> renderer,
             tools::build_with_progress(std::move(loaded.scene), options.scene));
  render::PanoramaView reference_view = view;
  reference_view.quality = front.best().quality.render;
  reference_view.quality.samples = options.reference_samples;
  reference_view.quality.bounces = options.reference_bounces.value_or(renderer->scene().bounces);
  reference_view.quality.firefly_limit = reference_view.quality.adaptive_error = 0.0f;
  reference_view.seed = view.seed + 1;  // Another seed: shared noise would make the error appear smaller.
  std::optional<Progress> progress(std::in_place, "rendering the reference");
  TRY_ASSIGN(const render::Film reference, converged_film(
                                               *renderer, reference_view, [&](double done) { progress->update(done); },
                                               [&] { return stop.requested(); }));
  progress.reset();
  TradeMeter meter(*renderer, view, reference.mean());
  PictureErrors errors(&meter, stop);
  GovernedLoop loop(*renderer, options, view, stop);
  nlohmann::json points = nlohmann::json::array();
  fmt::print("budget ms samples bounces scale denoised   ms p50   ms p95   relMSE    FLIP    bytes\n");
  for (const double budget_ms : options.budgets_ms) {
    TRY_ASSIGN(BudgetResult result, loop.hold(budget_ms, front, options.frames));
    TRY(errors.add_to(&result));
    print(result);
    points.push_back(json_of(result));
  }
  reference_view.seed = view.seed;
  TRY_ASSIGN(const Still still,
             rest(*renderer, reference_view, options.reference_samples / kReferencePerStill, reference.mean(), stop));
  for (std::size_t i = 0; i < still.mse.size(); ++i) {
    fmt::print("still, {:5} samples: mean squared error {:.3g}\n", still.samples[i], still.mse[i]);
  }
  fmt::print("slope {:.2f}\n", still.slope());
  if (options.json.empty()) return Done{};
  return tools::write_json(options.json,
                           {{"size", options.view.size},
                            {"points", points},
                            {"still", {{"samples", still.samples}, {"mse", still.mse}, {"slope", still.slope()}}}});
}

}  // namespace

tools::RenderCommand add_governed_command(CLI::App* program) {
  CLI::App* const parser =
      program->add_subcommand("governed", "Hold frame budgets on this machine, and measure the pictures' errors");
  const auto options = std::make_shared<GovernedOptions>();
  options->view.size = "320x120";
  tools::add_scene_options(parser, &options->scene);
  tools::add_view_options(parser, &options->view);
  parser->add_option("--budgets", options->budgets_ms, "Milliseconds per frame, separated by commas")
      ->delimiter(',')
      ->check(CLI::Range(1.0, 1e5))
      ->capture_default_str();
  parser->add_option("--front", options->front, "pareto_front.toml; if left out the scene's, or the standard one");
  parser->add_option("--frames", options->frames, "For each budget; the first half is for settling")
      ->check(CLI::Range(2, 10000))
      ->capture_default_str();
  parser->add_option("--reference-samples", options->reference_samples, "Of a pixel; at rest an eighth is reached")
      ->check(CLI::Range(2 * kReferencePerStill, render::kMaxSamples))
      ->capture_default_str();
  parser->add_option("--reference-bounces", options->reference_bounces, "The scene's if left out")
      ->check(CLI::Range(0, render::kMaxBounces));
  parser->add_option("--json", options->json, "Also write the figures, as JSON");
  return {parser, [options](const StopSignal& stop) { return governed(*options, stop); }};
}

}  // namespace cyclorama
