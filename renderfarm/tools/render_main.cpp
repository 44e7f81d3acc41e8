// SPDX-License-Identifier: Apache-2.0
/// cyclorama-render: pictures and facts of a scene, without a farm.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/resource.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "common/base/clock.h"
#include "common/base/file.h"
#include "common/base/text.h"
#include "common/image/png.h"
#include "common/process/log.h"
#include "common/process/program.h"
#include "common/process/progress.h"
#include "renderfarm/render/memory.h"
#include "renderfarm/render/renderer.h"
#include "renderfarm/render/requirements.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama {
namespace {

constexpr int kBandPx = 64;  ///< Rows that are rendered between two looks at the progress bar.
constexpr double kDegree = std::numbers::pi / 180.0;

struct Options {
  std::string scene;
  int threads = 0;
  std::string json;
  std::string out;
  std::string size = "2048x768";
  double azimuth_deg = 360.0;
  std::vector<double> eye;
  std::optional<double> heading_deg;
  int samples = 16;
  std::uint64_t seed = 0;
};

Error stopped() { return Error(ErrorCode::kUnavailable, "stopped before it was done"); }

struct Loaded {
  Scene scene;
  double seconds = 0.0;
};

Result<Loaded> load(const Options& options) {
  const SteadyClock clock;
  const TimePoint start = clock.now();
  Progress progress("loading");
  ImportLimits limits;
  limits.memory_bytes = available_memory().value_or(limits.memory_bytes);
  TRY_ASSIGN(Scene scene, load_scene(options.scene, limits, [&](double fraction) { progress.update(fraction); }));
  return Loaded{std::move(scene), to_seconds(clock.now() - start)};
}

Result<std::unique_ptr<Renderer>> build(Scene scene, const Options& options) {
  Progress progress("building the BVH");
  return Renderer::build(std::move(scene), options.threads, [&](double fraction) { progress.update(fraction); });
}

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

/// Square pixels, the horizon in the middle.
Result<PanoramaView> view_of(const Options& options, const SceneInfo& info) {
  TRY_ASSIGN(const auto size, parse_size(options.size));
  PanoramaView view;
  view.eye = options.eye.empty() ? info.start_eye : Eigen::Vector3d(options.eye[0], options.eye[1], options.eye[2]);
  view.heading_rad = options.heading_deg ? *options.heading_deg * kDegree : info.start_heading_rad;
  const double span = options.azimuth_deg * kDegree;
  const double tan_half = 0.5 * span * size.second / size.first;
  view.panorama = {size.first, size.second, span, tan_half, -tan_half};
  view.samples = options.samples;
  view.seed = options.seed;
  TRY(check_view(view, {}));
  return view;
}

Status write_json(const std::string& path, const nlohmann::json& values) {
  return write_file_atomically(path, std::string_view(values.dump(2) + "\n"));
}

Status picture(const Options& options, const StopSignal& stop) {
  TRY_ASSIGN(Loaded loaded, load(options));
  TRY_ASSIGN(const PanoramaView view, view_of(options, loaded.scene.info));
  if (stop.requested()) return stopped();
  TRY_ASSIGN(const std::unique_ptr<Renderer> renderer, build(std::move(loaded.scene), options));
  RgbImage image(view.panorama.width_px, view.panorama.height_px);
  RenderCost cost;
  {
    Progress progress("rendering");
    for (int y = 0; y < image.height(); y += kBandPx) {
      const PixelRect band{0, y, image.width(), std::min(kBandPx, image.height() - y)};
      RgbImage pixels;
      const RenderCost part = renderer->render(view, band, &pixels, [&] { return stop.requested(); });
      if (stop.requested()) return stopped();
      std::copy(pixels.data().begin(), pixels.data().end(), image.at(0, y));
      cost.cpu_seconds += part.cpu_seconds;
      cost.wall_seconds += part.wall_seconds;
      cost.rays += part.rays;
      progress.update(static_cast<double>(y + band.height) / image.height());
    }
  }
  TRY(write_png(options.out, image));
  const double megarays = static_cast<double>(cost.rays) / 1e6;
  fmt::print("{}: {:.1f} million rays in {:.2f} s, {:.2f} cpu-seconds: {:.2f} million rays per cpu-second\n",
             options.out, megarays, cost.wall_seconds, cost.cpu_seconds, megarays / cost.cpu_seconds);
  if (options.json.empty()) return Done{};
  return write_json(options.json, {{"rays", cost.rays}, {"wall_s", cost.wall_seconds}, {"cpu_s", cost.cpu_seconds}});
}

std::string text_of(const Eigen::Vector3d& v) { return fmt::format("({:.2f}, {:.2f}, {:.2f})", v.x(), v.y(), v.z()); }
std::string text_of(const Eigen::Vector3f& v) { return fmt::format("({:.3g}, {:.3g}, {:.3g})", v.x(), v.y(), v.z()); }

void print_light(const Scene& scene) {
  for (const Light& light : scene.model.lights) {
    const char* const kind = light.kind == LightKind::kPoint  ? "point"
                             : light.kind == LightKind::kSpot ? "spot"
                                                              : "directional";
    fmt::print("  {} light '{}' at {}, intensity {}, radius {:.3f}\n", kind, printable(light.name),
               text_of(light.position), text_of(light.intensity), light.radius_m);
  }
  fmt::print("sky         zenith {}, horizon {}, ground {}\n", text_of(scene.sky.zenith), text_of(scene.sky.horizon),
             text_of(scene.sky.ground));
  fmt::print("ambient     {}\neye lamp    {} cd\nexposure    {:.3f}\n", text_of(scene.ambient), text_of(scene.eye_lamp),
             scene.exposure);
}

Status inspect(const Options& options) {
  TRY_ASSIGN(const Loaded loaded, load(options));
  const Scene& scene = loaded.scene;
  const Model& model = scene.model;
  std::size_t texels = 0;
  for (const Texture& texture : model.textures) texels += texture.pixels.data().size() / 4;
  fmt::print("title       {}\ncredits     {}\n", printable(scene.info.title, 200), printable(scene.info.credits, 400));
  fmt::print("triangles   {} stored, {} seen\n", scene.triangles_stored(), scene.triangles_seen());
  fmt::print("parts       {} meshes, {} instances, {} materials, {} textures ({:.1f} million texels)\n",
             model.meshes.size(), model.instances.size(), model.materials.size(), model.textures.size(),
             static_cast<double>(texels) / 1e6);
  fmt::print("memory      {} without the BVH\n", describe_bytes(scene.memory_bytes()));
  fmt::print("bounds      {} to {} m\n", text_of(Eigen::Vector3d(scene.bounds.min())),
             text_of(Eigen::Vector3d(scene.bounds.max())));
  fmt::print("start       {}, heading {:.1f} degrees, eye height {:.2f} m, {} corners to walk in, {} tour stops\n",
             text_of(scene.info.start_eye), scene.info.start_heading_rad / kDegree, scene.info.eye_height_m,
             scene.info.walkable.size(), scene.info.stops.size());
  fmt::print("lights      {}\n", model.lights.size());
  print_light(scene);
  fmt::print("kernel      compiled for: {}\n", describe(needs_of(scene)));
  for (const std::string& note : model.notes) fmt::print("note        {}\n", printable(note, 400));
  return Done{};
}

std::size_t peak_memory() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

Status measure_load(const Options& options, const StopSignal& stop) {
  TRY_ASSIGN(Loaded loaded, load(options));
  if (stop.requested()) return stopped();
  const double load_seconds = loaded.seconds;
  const std::uint64_t stored = loaded.scene.triangles_stored();
  const std::uint64_t seen = loaded.scene.triangles_seen();
  const std::size_t scene_bytes = loaded.scene.memory_bytes();
  TRY_ASSIGN(const std::unique_ptr<Renderer> renderer, build(std::move(loaded.scene), options));
  const auto per_triangle = [&](std::size_t bytes) { return static_cast<double>(bytes) / static_cast<double>(stored); };
  const double bvh_seconds = renderer->build_seconds();
  const std::size_t bvh_bytes = renderer->bvh_bytes();
  fmt::print("{} triangles stored, {} seen; loaded in {:.2f} s, BVH in {:.2f} s\n", stored, seen, load_seconds,
             bvh_seconds);
  fmt::print("{:.1f} bytes per triangle, and {:.1f} for the BVH; {} at most\n", per_triangle(scene_bytes),
             per_triangle(bvh_bytes), describe_bytes(peak_memory()));
  if (options.json.empty()) return Done{};
  return write_json(options.json, {{"triangles", stored},
                                   {"triangles_seen", seen},
                                   {"load_s", load_seconds},
                                   {"bvh_s", bvh_seconds},
                                   {"seconds", load_seconds + bvh_seconds},
                                   {"scene_bytes", scene_bytes},
                                   {"bvh_bytes", bvh_bytes},
                                   {"scene_bytes_per_triangle", per_triangle(scene_bytes)},
                                   {"bvh_bytes_per_triangle", per_triangle(bvh_bytes)},
                                   {"bytes_per_triangle", per_triangle(scene_bytes + bvh_bytes)},
                                   {"peak_rss_bytes", peak_memory()}});
}

void add_common(CLI::App* command, Options* options) {
  command->add_option("scene", options->scene, "A scene package, or one .glb, .gltf, .ply or .obj file")->required();
  command->add_option("--threads", options->threads, "Threads; 0 is all")->check(CLI::Range(0, 1024));
}

}  // namespace
}  // namespace cyclorama

int main(int argc, char** argv) {
  using namespace cyclorama;
  Options options;
  Program program("cyclorama-render", "Pictures and facts of a scene, without a farm.");
  CLI::App& app = program.options();
  app.require_subcommand(1);

  CLI::App* const picture_command = app.add_subcommand("picture", "Render a panorama into a PNG");
  add_common(picture_command, &options);
  picture_command->add_option("--out", options.out, "The picture to write")->required();
  picture_command->add_option("--size", options.size, "WIDTHxHEIGHT in pixels")->capture_default_str();
  picture_command->add_option("--azimuth-deg", options.azimuth_deg, "Width of the view")->capture_default_str();
  picture_command->add_option("--eye", options.eye, "x,y,z in metres; the scene's start if left out")
      ->delimiter(',')
      ->expected(3);
  picture_command->add_option("--heading-deg", options.heading_deg,
                              "Positive to the right; the scene's start if left out");
  picture_command->add_option("--samples", options.samples, "Samples per pixel")->capture_default_str();
  picture_command->add_option("--seed", options.seed, "Changes the noise")->capture_default_str();
  picture_command->add_option("--json", options.json, "Also write what it cost, as JSON");

  CLI::App* const inspect_command = app.add_subcommand("inspect", "Print what a scene holds and which kernel it gets");
  add_common(inspect_command, &options);

  CLI::App* const load_command = app.add_subcommand("load", "Measure loading: seconds and bytes");
  add_common(load_command, &options);
  load_command->add_option("--json", options.json, "Also write the figures as JSON");

  return program.run(argc, argv, [&](const StopSignal& stop) -> Status {
    if (*picture_command) return picture(options, stop);
    if (*inspect_command) return inspect(options);
    return measure_load(options, stop);
  });
}
