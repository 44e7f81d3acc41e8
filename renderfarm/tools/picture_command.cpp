// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/tools/picture_command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "common/base/named_number.h"
#include "common/image/pfm.h"
#include "common/image/png.h"
#include "common/process/progress.h"
#include "renderfarm/denoise/denoising_renderer.h"
#include "renderfarm/light/light_file.h"
#include "renderfarm/tools/view_options.h"

namespace cyclorama::tools {
namespace {

constexpr int kBandPx = 64;  ///< Rows rendered between two updates of the progress bar.

struct PictureOptions {
  SceneOptions scene;
  std::string json;
  std::string out;
  ViewOptions view;
  render::RenderQuality quality;
  bool denoise = false;
  std::string light;
  std::optional<int> bounces;
  std::vector<std::string> lamps;  ///< GROUP=LEVEL.
};

/// Calls `render` for each band of `band_px` rows and adds up the costs that it returns.
template <typename Image, typename Render>
Result<Image> in_bands(const render::PanoramaView& view, int band_px, const StopSignal& stop,
                       render::RenderCost* ret_cost, Render render) {
  Image image(view.picture().width_px(), view.picture().height_px());
  Progress progress("rendering");
  for (int y = 0; y < image.height(); y += band_px) {
    const PixelRect band{0, y, image.width(), std::min(band_px, image.height() - y)};
    Image pixels;
    const render::RenderCost part = render(band, &pixels);
    if (stop.requested()) return stopped();
    std::copy(pixels.data().begin(), pixels.data().end(), image.at(0, y));
    ret_cost->cpu_seconds += part.cpu_seconds;
    ret_cost->wall_seconds += part.wall_seconds;
    ret_cost->rays += part.rays;
    progress.update(static_cast<double>(y + band.height) / image.height());
  }
  return image;
}

/// Returns the levels of the groups that the options name. Errors: kInvalidArgument for a text that is not GROUP=LEVEL
/// and for a name that is not the scene's.
Result<scene::LampLevels> levels_of(const PictureOptions& options, const scene::SceneInfo& info) {
  scene::LampLevels levels = scene::kAuthoredLamps;
  for (const std::string& text : options.lamps) {
    TRY_ASSIGN(const NamedNumber level, parse_named_number(text));
    const auto group = std::ranges::find(info.lamp_groups, level.name);
    if (group == info.lamp_groups.end()) {
      return Error(
          ErrorCode::kInvalidArgument,
          fmt::format("the scene has no group of lamps '{}'; it has {}", level.name,
                      info.lamp_groups.empty() ? "none" : fmt::format("{}", fmt::join(info.lamp_groups, ", "))));
    }
    levels[1 + static_cast<std::size_t>(group - info.lamp_groups.begin())] = static_cast<float>(level.number);
  }
  return levels;
}

Status picture(const PictureOptions& options, const StopSignal& stop) {
  TRY_ASSIGN(LoadedScene loaded, load_with_progress(options.scene));
  TRY_ASSIGN(render::PanoramaView view, view_of(options.view, loaded.scene.info));
  TRY_ASSIGN(view.lamps, levels_of(options, loaded.scene.info));
  view.quality = options.quality;
  view.quality.bounces = options.bounces.value_or(loaded.scene.bounces);
  TRY(render::check_view(view, {}));
  if (options.denoise) TRY(denoise::check_denoisable(view));
  if (stop.requested()) return stopped();
  TRY_ASSIGN(const std::unique_ptr<render::Renderer> renderer,
             build_with_progress(std::move(loaded.scene), options.scene));
  if (!options.light.empty()) {
    TRY_ASSIGN(light::LightStore store, light::read_light_file(options.light));
    TRY(renderer->set_light(std::make_shared<light::LightStore>(std::move(store)), options.light));
    view.quality.stored_light = true;
  }
  denoise::DenoisingRenderer denoising(*renderer);
  // Each denoised band would need a margin, so denoised pictures have only one band.
  const int band_px = options.denoise ? view.picture().height_px() : kBandPx;
  render::RenderCost cost;
  const auto cancelled = [&] { return stop.requested(); };
  if (std::filesystem::path(options.out).extension() == ".pfm") {
    TRY_ASSIGN(const RadianceImage image,
               in_bands<RadianceImage>(view, band_px, stop, &cost, [&](const PixelRect& band, auto* ret) {
                 return options.denoise ? denoising.render_radiance(view, band, ret, cancelled)
                                        : renderer->render_radiance(view, band, ret, cancelled);
               }));
    TRY(write_pfm(options.out, image));
  } else {
    TRY_ASSIGN(const RgbImage image,
               in_bands<RgbImage>(view, band_px, stop, &cost, [&](const PixelRect& band, auto* ret) {
                 return options.denoise ? denoising.render(view, band, ret, cancelled)
                                        : renderer->render(view, band, ret, cancelled);
               }));
    TRY(write_png(options.out, image));
  }
  const double megarays = static_cast<double>(cost.rays) / 1e6;
  fmt::print("{}: {:.1f} million rays in {:.2f} s, {:.2f} cpu-seconds: {:.2f} million rays per cpu-second\n",
             options.out, megarays, cost.wall_seconds, cost.cpu_seconds, megarays / cost.cpu_seconds);
  if (options.json.empty()) return Done{};
  return write_json(options.json, {{"rays", cost.rays}, {"wall_s", cost.wall_seconds}, {"cpu_s", cost.cpu_seconds}});
}

}  // namespace

RenderCommand add_picture_command(CLI::App* program) {
  CLI::App* const parser = program->add_subcommand("picture", "Render a picture into a PNG or PFM");
  const auto options = std::make_shared<PictureOptions>();
  add_scene_options(parser, &options->scene);
  parser->add_option("--out", options->out, "The picture to write; .pfm holds linear light instead of codes")
      ->required();
  add_view_options(parser, &options->view);
  options->quality.samples = 16;
  parser->add_option("--samples", options->quality.samples, "Samples per pixel")->capture_default_str();
  parser->add_option("--bounces", options->bounces, "Bounces of light between surfaces; default: the scene's");
  parser->add_option("--light-samples", options->quality.light_samples, "Shadow rays at directly visible surfaces")
      ->capture_default_str();
  parser
      ->add_option("--firefly-limit", options->quality.firefly_limit,
                   "Upper bound of a sample's indirect light; 0 disables it")
      ->capture_default_str();
  parser
      ->add_option("--adaptive-error", options->quality.adaptive_error,
                   "Stop sampling a pixel at this error; 0 disables it")
      ->capture_default_str();
  parser->add_flag("--denoise", options->denoise, "Denoise, with a bias; only for a panorama for one eye");
  parser
      ->add_option("--light", options->light, "File of stored light (cyclorama-render light) to read where it has any")
      ->check(CLI::ExistingFile);
  parser->add_option("--lamps", options->lamps, "GROUP=LEVEL of a group of lamps, 0 to 4; repeat it");
  parser->add_option("--json", options->json, "Also write the cost, as JSON");
  return {parser, [options](const StopSignal& stop) { return picture(*options, stop); }};
}

}  // namespace cyclorama::tools
