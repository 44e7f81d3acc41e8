// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/trade_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "common/base/file.h"
#include "common/base/text.h"
#include "common/image/image_file.h"
#include "common/image/pfm.h"
#include "common/process/progress.h"
#include "renderfarm/governor/pareto_front_file.h"
#include "renderfarm/tools/view_options.h"
#include "tests/bench/render/trade/trade_meter.h"

namespace cyclorama {
namespace {

struct TradeOptions {
  tools::SceneOptions scene;
  tools::ViewOptions view;
  std::string out;
  bool quick = false;
  std::optional<int> reference_samples;
  std::optional<int> reference_bounces;
};

constexpr const char* kOwnFiles[] = {"reference.pfm", "reference.txt", "trade.csv", "trade.svg",
                                     governor::kParetoFrontFileName};

/// Identifies the scene's files: those of a package's folder, or the single file.
std::string files_of(const TradeOptions& options) {
  namespace fs = std::filesystem;
  std::error_code failed;
  std::uint64_t count = 0, bytes = 0;
  fs::file_time_type newest = fs::file_time_type::min();
  const auto add = [&](const fs::path& file) {
    if (!fs::is_regular_file(file, failed)) return;
    ++count;
    bytes += fs::file_size(file, failed);
    newest = std::max(newest, fs::last_write_time(file, failed));
  };
  const auto is_own = [&](const fs::path& file) {  // The output folder may be the package's.
    return std::ranges::find(kOwnFiles, file.filename()) != std::end(kOwnFiles) &&
           fs::equivalent(file.parent_path(), options.out, failed);
  };
  const fs::path scene = options.scene.scene;
  if (fs::is_directory(scene, failed) || scene.filename() == "scene.toml") {
    const fs::path folder = fs::is_directory(scene, failed) ? scene : fs::absolute(scene, failed).parent_path();
    for (fs::recursive_directory_iterator file(folder, failed), end; !failed && file != end; file.increment(failed)) {
      if (!is_own(file->path())) add(file->path());
    }
  } else {
    add(scene);
  }
  return fmt::format("{} files, {} bytes, newest {}", count, bytes, newest.time_since_epoch().count());
}

/// Everything on which the reference depends.
std::string settings_of(const render::PanoramaView& view, const TradeOptions& options, std::uint64_t triangles) {
  const Panorama& panorama = view.panorama;
  return fmt::format(
      "cyclorama {}\nscene '{}', {} triangles, {}\neye {} {} {}, heading {} rad\n{}x{}, {} rad, tan elevation {} to "
      "{}\n"
      "{} samples, {} bounces, seed {}\n",
      CYCLORAMA_VERSION, options.scene.scene, triangles, files_of(options), view.eye.x(), view.eye.y(), view.eye.z(),
      view.heading_rad, panorama.width_px, panorama.height_px, panorama.azimuth_span_rad, panorama.tan_elevation_bottom,
      panorama.tan_elevation_top, view.quality.samples, view.quality.bounces, view.seed);
}

Result<RadianceImage> reference_of(const render::Renderer& renderer, const render::PanoramaView& view,
                                   const TradeOptions& options, const StopSignal& stop) {
  const std::filesystem::path folder = options.out;
  const std::filesystem::path picture_file = folder / "reference.pfm";
  const std::filesystem::path settings_file = folder / "reference.txt";
  const std::string settings = settings_of(view, options, renderer.scene().triangles_seen());
  constexpr std::size_t kSettingsLimit = 65536;
  if (const auto made_with = read_text_file(settings_file, kSettingsLimit); made_with && *made_with == settings) {
    Result<RadianceImage> picture = read_pfm(picture_file, kPhotoLimitPx);
    if (picture && picture->width() == view.panorama.width_px && picture->height() == view.panorama.height_px) {
      fmt::print(stderr, "the reference is '{}'\n", picture_file.string());
      return picture;
    }
  }
  Progress progress("rendering the reference");
  TRY_ASSIGN(const render::Film film, converged_film(
                                          renderer, view, [&](double fraction) { progress.update(fraction); },
                                          [&] { return stop.requested(); }));
  fmt::print(stderr, "the reference's own relMSE is at most {:.2g}\n", own_relmse(film));
  RadianceImage mean = film.mean();
  TRY(write_pfm(picture_file, mean));
  TRY(write_file_atomically(settings_file, settings));
  return mean;
}

Result<std::vector<TradePoint>> sweep(TradeMeter* meter, bool quick, const StopSignal& stop) {
  const std::vector<PlannedPoint> plan = trade_plan(quick);
  std::vector<TradePoint> points;
  Progress progress(fmt::format("measuring {} settings", plan.size()));
  for (const PlannedPoint& planned : plan) {
    TRY_ASSIGN(TradePoint point, meter->measure(planned, [&] { return stop.requested(); }));
    points.push_back(std::move(point));
    progress.update(static_cast<double>(points.size()) / static_cast<double>(plan.size()));
  }
  return points;
}

void print_pareto_front(const std::vector<TradePoint>& points, const governor::ParetoFront& front) {
  fmt::print("{:>7} {:>7} {:>6} {:>8} {:>8} {:>5} {:>8} {:>9} {:>8} {:>7} {:>8}\n", "samples", "bounces", "lights",
             "firefly", "adaptive", "scale", "denoised", "cpu ms", "relMSE", "FLIP", "bytes");
  for (std::size_t i = 0; i < front.size(); ++i) {
    const auto on_it = [&](const TradePoint& point) { return point.planned.quality == front[i].quality; };
    const TradePoint& point = *std::ranges::find_if(points, on_it);
    const render::PictureQuality& quality = point.planned.quality;
    const render::RenderQuality& render = quality.render;
    fmt::print("{:>7} {:>7} {:>6} {:>8} {:>8} {:>5} {:>8} {:>9.1f} {:>8.4f} {:>7.4f} {:>8}\n", render.samples,
               render.bounces, render.light_samples, render.firefly_limit, render.adaptive_error, quality.scale,
               quality.denoise ? "yes" : "no", 1e3 * point.cpu_s, point.relmse, point.shown.flip, point.bytes);
  }
}

Status write_all(const std::vector<TradePoint>& points, const render::PanoramaView& view, const TradeOptions& options) {
  const Panorama& panorama = view.panorama;
  TRY_ASSIGN(const governor::ParetoFront front,
             trade_pareto_front(points, static_cast<double>(panorama.width_px) * panorama.height_px));
  const std::string title =
      fmt::format("{}, {}x{}", printable(std::filesystem::path(options.scene.scene).filename().string()),
                  panorama.width_px, panorama.height_px);
  const std::filesystem::path folder = options.out;
  TRY(write_file_atomically(folder / "trade.csv", trade_csv(points, front)));
  TRY(write_file_atomically(folder / "trade.svg", trade_svg(points, front, title)));
  TRY(write_file_atomically(
      folder / governor::kParetoFrontFileName,
      governor::pareto_front_text(
          front, fmt::format("Measured by 'cyclorama-bench-render trade': {}. The error is relMSE.", title))));
  print_pareto_front(points, front);
  return Done{};
}

Status trade(const TradeOptions& options, const StopSignal& stop) {
  std::error_code failed;
  std::filesystem::create_directories(options.out, failed);
  if (failed) {
    return Error(ErrorCode::kSystem, fmt::format("making the folder '{}': {}", options.out, failed.message()));
  }
  TRY_ASSIGN(tools::LoadedScene loaded, tools::load_with_progress(options.scene));
  TRY_ASSIGN(const render::PanoramaView view, tools::panorama_view_of(options.view, loaded.scene.info));
  if (stop.requested()) return tools::stopped();
  TRY_ASSIGN(const std::unique_ptr<render::Renderer> renderer,
             tools::build_with_progress(std::move(loaded.scene), options.scene));
  render::PanoramaView reference_view = view;
  reference_view.quality.samples = options.reference_samples.value_or(options.quick ? 256 : 1024);
  reference_view.quality.bounces = options.reference_bounces.value_or(renderer->scene().bounces);
  reference_view.seed = view.seed + 1;  // Another seed: shared noise would make the error appear smaller.
  TRY_ASSIGN(RadianceImage reference, reference_of(*renderer, reference_view, options, stop));
  TradeMeter meter(*renderer, view, std::move(reference));
  TRY_ASSIGN(const std::vector<TradePoint> points, sweep(&meter, options.quick, stop));
  return write_all(points, view, options);
}

}  // namespace

tools::RenderCommand add_trade_command(CLI::App* program) {
  CLI::App* const parser =
      program->add_subcommand("trade", "Measure how time and bytes are traded for accuracy, against a reference");
  const auto options = std::make_shared<TradeOptions>();
  options->view.size = "640x240";
  tools::add_scene_options(parser, &options->scene);
  tools::add_view_options(parser, &options->view);
  parser->add_option("--out", options->out, "The folder for trade.csv, trade.svg, pareto_front.toml and the reference")
      ->required();
  parser->add_flag("--quick", options->quick, "Fewer settings, and a reference of 256 samples");
  parser->add_option("--reference-samples", options->reference_samples, "Of a pixel; 1024 if left out")
      ->check(CLI::Range(2, render::kMaxSamples));
  parser->add_option("--reference-bounces", options->reference_bounces, "Of its paths; the scene's if left out")
      ->check(CLI::Range(0, render::kMaxBounces));
  return {parser, [options](const StopSignal& stop) { return trade(*options, stop); }};
}

}  // namespace cyclorama
