// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/balance/record_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <numbers>

#include "common/base/check.h"
#include "common/process/progress.h"
#include "renderfarm/balance/cost_record.h"
#include "renderfarm/tools/view_options.h"
#include "tests/bench/balance/eye_path.h"

namespace cyclorama {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

struct RecordOptions {
  tools::SceneOptions scene;
  tools::ViewOptions view;
  std::string path = "orbit";
  EyePathOptions eyes;
  double step_deg = 3.0;
  render::RenderQuality quality{.samples = 2, .bounces = 2};
  std::string out;
};

/// Measures the thread time of every cell of one picture.
balance::WorkGrid timed(const render::Renderer& renderer, const render::PanoramaView& view, const StopSignal& stop) {
  const balance::PictureSize size{view.panorama.width_px, view.panorama.height_px};
  render::Film film;
  const render::RenderCost cost =
      renderer.render_film(view, {0, 0, size.width, size.height}, false, &film, [&] { return stop.requested(); });
  balance::WorkGrid work(size);
  CHECK(cost.cell_cpu_seconds.size() == work.cells().size());
  std::ranges::copy(cost.cell_cpu_seconds, work.cells().begin());
  return work;
}

Status record(const RecordOptions& options, const StopSignal& stop) {
  TRY_ASSIGN(balance::CostRecorder recorder, balance::CostRecorder::create(options.out));
  TRY_ASSIGN(tools::LoadedScene loaded, tools::load_with_progress(options.scene));
  TRY_ASSIGN(render::PanoramaView view, tools::panorama_view_of(options.view, loaded.scene.info));
  EyePathOptions eyes = options.eyes;
  eyes.step_rad = options.step_deg * kDegree;
  const scene::SceneInfo info = loaded.scene.info;
  const std::vector<EyePose> path = options.path == "walk" ? walk(info, eyes) : orbit(info, loaded.scene.bounds, eyes);
  TRY_ASSIGN(const std::unique_ptr<render::Renderer> renderer,
             tools::build_with_progress(std::move(loaded.scene), options.scene));
  view.quality = options.quality;
  double seconds = 0.0;
  Progress progress("recording");
  for (std::size_t i = 0; i < path.size(); ++i) {
    view.eye = path[i].eye;
    view.heading_rad = path[i].heading_rad;
    view.seed = options.view.seed + i;
    TRY(render::check_view(view, {}));
    balance::RecordedFrame frame{timed(*renderer, view, stop),
                                 view.heading_rad,
                                 view.panorama.azimuth_span_rad,
                                 {view.eye.x(), view.eye.y(), view.eye.z()}};
    if (stop.requested()) return tools::stopped();
    seconds += frame.work.total();
    TRY(recorder.add(frame));
    progress.update(static_cast<double>(i + 1) / static_cast<double>(path.size()));
  }
  fmt::print("{}: {} frames of {}x{}, {:.3f} cpu-seconds each\n", options.out, path.size(), view.panorama.width_px,
             view.panorama.height_px, seconds / static_cast<double>(path.size()));
  return Done{};
}

}  // namespace

tools::RenderCommand add_record_command(CLI::App* program) {
  CLI::App* const parser =
      program->add_subcommand("record", "Render a way through a scene, and record what each cell of 16x16 pixels cost");
  const auto options = std::make_shared<RecordOptions>();
  options->view.size = "960x540";
  options->view.camera.field_deg = 75.0;
  tools::add_scene_options(parser, &options->scene);
  tools::add_view_options(parser, &options->view);
  parser->add_option("--path", options->path, "orbit: around a point ahead of the scene's start; walk: to its stops")
      ->check(CLI::IsMember({"orbit", "walk"}))
      ->capture_default_str();
  parser->add_option("--frames", options->eyes.frames, "Pictures")->check(CLI::Range(1, 100000))->capture_default_str();
  parser->add_option("--step-deg", options->step_deg, "Turn per frame: of an orbit always, of a walk at most")
      ->check(CLI::Range(0.0, 90.0))
      ->capture_default_str();
  parser->add_option("--step-m", options->eyes.step_m, "Of a walk, per frame")
      ->check(CLI::Range(0.001, 100.0))
      ->capture_default_str();
  parser->add_option("--radius-m", options->eyes.radius_m, "Of an orbit; found from the scene if left out")
      ->check(CLI::Range(0.0, 1e6));
  parser->add_option("--samples", options->quality.samples, "Per pixel")
      ->check(CLI::Range(1, render::kMaxSamples))
      ->capture_default_str();
  parser->add_option("--bounces", options->quality.bounces, "Of light; 2 makes paths of four vertices")
      ->check(CLI::Range(0, render::kMaxBounces))
      ->capture_default_str();
  parser->add_option("-o,--out", options->out, "The record; a file that does not exist yet")->required();
  return {parser, [options](const StopSignal& stop) { return record(*options, stop); }};
}

}  // namespace cyclorama
