// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/tools/picture_command.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "common/base/text.h"
#include "common/image/pfm.h"
#include "common/image/png.h"
#include "common/process/progress.h"
#include "renderfarm/tools/camera_options.h"

namespace cyclorama {
namespace {

constexpr int kBandPx = 64;  ///< Rows that are rendered between two looks at the progress bar.
constexpr double kDegree = std::numbers::pi / 180.0;

struct PictureOptions {
  SceneOptions scene;
  std::string json;
  std::string out;
  std::string size = "2048x768";
  CameraOptions camera;
  std::vector<double> eye;
  std::optional<double> heading_deg;
  RenderQuality quality;
  std::uint64_t seed = 0;
};

Result<std::pair<int, int>> parse_size(const std::string& size) {
  const std::size_t cross = size.find('x');
  const auto width = parse_integer(std::string_view(size).substr(0, cross));
  const auto height =
      cross == std::string::npos ? std::nullopt : parse_integer(std::string_view(size).substr(cross + 1));
  constexpr long long kLargest = 16384;
  if (width && height && *width > 0 && *height > 0 && *width <= kLargest && *height <= kLargest) {
    return std::pair(static_cast<int>(*width), static_cast<int>(*height));
  }
  return Error(ErrorCode::kInvalidArgument,
               fmt::format("--size '{}' is not WIDTHxHEIGHT, each 1 to {}", printable(size), kLargest));
}

Result<PanoramaView> view_of(const PictureOptions& options, const SceneInfo& info) {
  TRY_ASSIGN(const auto size, parse_size(options.size));
  PanoramaView view;
  view.eye = options.eye.empty() ? info.start_eye : Eigen::Vector3d(options.eye[0], options.eye[1], options.eye[2]);
  view.heading_rad = options.heading_deg ? *options.heading_deg * kDegree : info.start_heading_rad;
  TRY_ASSIGN(view.projection, projection_of(options.camera, size.first, size.second));
  view.quality = options.quality;
  view.seed = options.seed;
  TRY(check_view(view, {}));
  return view;
}

/// `render` makes one band and answers what it cost.
template <typename Image, typename Render>
Result<Image> in_bands(const PanoramaView& view, const StopSignal& stop, RenderCost* ret_cost, Render render) {
  Image image(view.picture().width_px(), view.picture().height_px());
  Progress progress("rendering");
  for (int y = 0; y < image.height(); y += kBandPx) {
    const PixelRect band{0, y, image.width(), std::min(kBandPx, image.height() - y)};
    Image pixels;
    const RenderCost part = render(band, &pixels);
    if (stop.requested()) return stopped();
    std::copy(pixels.data().begin(), pixels.data().end(), image.at(0, y));
    ret_cost->cpu_seconds += part.cpu_seconds;
    ret_cost->wall_seconds += part.wall_seconds;
    ret_cost->rays += part.rays;
    progress.update(static_cast<double>(y + band.height) / image.height());
  }
  return image;
}

Status picture(const PictureOptions& options, const StopSignal& stop) {
  TRY_ASSIGN(LoadedScene loaded, load_with_progress(options.scene));
  TRY_ASSIGN(const PanoramaView view, view_of(options, loaded.scene.info));
  if (stop.requested()) return stopped();
  TRY_ASSIGN(const std::unique_ptr<Renderer> renderer, build_with_progress(std::move(loaded.scene), options.scene));
  RenderCost cost;
  const auto cancelled = [&] { return stop.requested(); };
  if (std::filesystem::path(options.out).extension() == ".pfm") {
    TRY_ASSIGN(const RadianceImage image,
               in_bands<RadianceImage>(view, stop, &cost, [&](const PixelRect& band, auto* ret) {
                 return renderer->render_radiance(view, band, ret, cancelled);
               }));
    TRY(write_pfm(options.out, image));
  } else {
    TRY_ASSIGN(const RgbImage image, in_bands<RgbImage>(view, stop, &cost, [&](const PixelRect& band, auto* ret) {
                 return renderer->render(view, band, ret, cancelled);
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
  parser->add_option("--size", options->size, "WIDTHxHEIGHT in pixels, of each eye")->capture_default_str();
  add_camera_options(parser, &options->camera);
  parser->add_option("--eye", options->eye, "x,y,z in metres; the scene's start if left out")
      ->delimiter(',')
      ->expected(3);
  parser->add_option("--heading-deg", options->heading_deg, "Positive to the right; the scene's start if left out");
  options->quality.samples = 16;
  parser->add_option("--samples", options->quality.samples, "Samples per pixel")->capture_default_str();
  parser->add_option("--bounces", options->quality.bounces, "Times that light goes from surface to surface")
      ->capture_default_str();
  parser->add_option("--light-samples", options->quality.light_samples, "Shadow rays at what the eye sees")
      ->capture_default_str();
  parser->add_option("--firefly-limit", options->quality.firefly_limit, "Of a sample's indirect light; 0 is none")
      ->capture_default_str();
  parser->add_option("--adaptive-error", options->quality.adaptive_error, "Stop a pixel at this error; 0 is never")
      ->capture_default_str();
  parser->add_option("--seed", options->seed, "Changes the noise")->capture_default_str();
  parser->add_option("--json", options->json, "Also write what it cost, as JSON");
  return {parser, [options](const StopSignal& stop) { return picture(*options, stop); }};
}

}  // namespace cyclorama
