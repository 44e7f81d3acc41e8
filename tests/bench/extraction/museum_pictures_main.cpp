// SPDX-License-Identifier: Apache-2.0
/// cyclorama-bench-museum: writes the pictures and the depth that a museum would get for a list of views, for
/// `./bench.sh extraction`, which makes geometry from them.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "common/base/file.h"
#include "common/image/inverse_depth.h"
#include "common/image/jpeg.h"
#include "common/image/watermark.h"
#include "renderfarm/light/light_file.h"
#include "renderfarm/quality/enlarge.h"
#include "renderfarm/quality/flip.h"
#include "renderfarm/render/renderer.h"
#include "renderfarm/scene/scene.h"

namespace {

using namespace cyclorama;

constexpr double kDegree = std::numbers::pi / 180.0;

struct PicturesOptions {
  std::string scene;
  std::string views;
  std::string out;
  std::string light;
  std::string json;
  int width = 1280;
  int height = 960;
  double field_deg = 75.0;
  int samples = 4;
  int quality = 85;
  std::uint64_t watermark = 0;
  double warp_px = 0.0;
  std::uint64_t warp_seed = 1;
};

/// A view of the file: its name, eye, heading and tilt, and the size of its picture before it is enlarged, 1 or less.
struct MuseumView {
  std::string name;
  std::array<double, 3> eye{};
  double heading_deg = 0.0;
  double tilt_deg = 0.0;
  double scale = 1.0;
};

Result<std::vector<MuseumView>> read_views(const std::string& path) {
  std::vector<MuseumView> views;
  std::ifstream file(path);
  MuseumView view;
  while (file >> view.name >> view.eye[0] >> view.eye[1] >> view.eye[2] >> view.heading_deg >> view.tilt_deg >>
         view.scale) {
    views.push_back(view);
  }
  if (views.empty() || !file.eof())
    return Error(ErrorCode::kBadData, fmt::format("{}: each line must have a name and six numbers", path));
  return views;
}

/// A smooth displacement of the whole picture, other for each session: waves that are longer than a third of it.
class Warp {
 public:
  Warp(double amplitude_px, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> wave(-3.0, 3.0);
    std::uniform_real_distribution<double> phase(0.0, 2.0 * std::numbers::pi);
    for (Wave& each : waves_) each = {wave(random), wave(random), phase(random), phase(random)};
    amplitude_px_ = amplitude_px / std::sqrt(0.5 * static_cast<double>(waves_.size()));
  }

  [[nodiscard]] RgbImage applied(const RgbImage& picture) const {
    RgbImage out(picture.width(), picture.height());
    for (int y = 0; y < out.height(); ++y) {
      for (int x = 0; x < out.width(); ++x) {
        double dx = 0.0;
        double dy = 0.0;
        for (const Wave& wave : waves_) {
          const double at = 2.0 * std::numbers::pi * (wave.across * x / out.width() + wave.down * y / out.height());
          dx += amplitude_px_ * std::sin(at + wave.phase_x);
          dy += amplitude_px_ * std::sin(at + wave.phase_y);
        }
        sample(picture, x + dx, y + dy, out.at(x, y));
      }
    }
    return out;
  }

 private:
  struct Wave {
    double across, down, phase_x, phase_y;
  };
  static void sample(const RgbImage& picture, double x, double y, std::uint8_t* ret) {
    x = std::clamp(x, 0.0, picture.width() - 1.001);
    y = std::clamp(y, 0.0, picture.height() - 1.001);
    const int left = static_cast<int>(x);
    const int top = static_cast<int>(y);
    const double u = x - left;
    const double v = y - top;
    for (int c = 0; c < 3; ++c) {
      const double upper = (1.0 - u) * picture.at(left, top)[c] + u * picture.at(left + 1, top)[c];
      const double lower = (1.0 - u) * picture.at(left, top + 1)[c] + u * picture.at(left + 1, top + 1)[c];
      ret[c] = static_cast<std::uint8_t>(std::lround((1.0 - v) * upper + v * lower));
    }
  }
  std::array<Wave, 6> waves_;
  double amplitude_px_ = 0.0;  ///< Amplitude of each wave; that of the options is the root mean square of the sum.
};

Status write_depth(const std::filesystem::path& path, const InverseDepthImage& depth) {
  return write_file_atomically(path, std::as_bytes(depth.data()));
}

Status write_pictures(const PicturesOptions& options) {
  TRY_ASSIGN(const std::vector<MuseumView> views, read_views(options.views));
  TRY_ASSIGN(scene::Scene scene, scene::load_scene(options.scene, {}, [](double) {}));
  const int bounces = scene.bounces;
  TRY_ASSIGN(const std::unique_ptr<render::Renderer> renderer, render::Renderer::build(std::move(scene), 0, nullptr));
  if (!options.light.empty()) {
    TRY_ASSIGN(light::LightStore store, light::read_light_file(options.light));
    TRY(renderer->set_light(std::make_shared<light::LightStore>(std::move(store)), options.light));
  }
  const Warp warp(options.warp_px, options.warp_seed);
  JpegEncoder encoder;
  double flip = 0.0;
  int judged = 0;
  for (const MuseumView& of : views) {
    render::PanoramaView view;
    view.eye = {of.eye[0], of.eye[1], of.eye[2]};
    view.heading_rad = of.heading_deg * kDegree;
    const int width = static_cast<int>(options.width * of.scale);
    const int height = static_cast<int>(options.height * of.scale);
    view.projection =
        Projection{Perspective::from_field(width, height, options.field_deg * kDegree, of.tilt_deg * kDegree), {}};
    view.quality.samples = options.samples;
    view.quality.bounces = bounces;
    view.quality.stored_light = !options.light.empty();
    view.depth = true;
    const PixelRect whole{0, 0, width, height};
    TRY(render::check_view(view, whole));
    RgbImage picture;
    InverseDepthImage depth;
    renderer->render(view, whole, &picture, nullptr, &depth);
    if (of.scale < 1.0) picture = quality::enlarged(picture, options.width, options.height);
    const PixelRect full{0, 0, options.width, options.height};
    RgbImage shown = options.warp_px > 0.0 ? warp.applied(picture) : picture;
    add_watermark(options.watermark, full, &shown);
    constexpr int kJudged = 4;
    if (of.scale == 1.0 && judged < kJudged && shown != picture) {
      TRY_ASSIGN(const quality::Flip error, quality::flip(shown, picture));
      flip += error.mean;
      ++judged;
    }
    TRY_ASSIGN(const std::vector<std::byte> jpeg, encoder.encode(shown, {.quality = options.quality}));
    const std::filesystem::path path = std::filesystem::path(options.out) / of.name;
    TRY(write_file_atomically(path, jpeg));
    TRY(write_depth(path.string() + ".depth", depth));
  }
  const double mean = judged == 0 ? 0.0 : flip / judged;
  fmt::print("{} pictures, FLIP {:.4f}\n", views.size(), mean);
  std::ofstream(options.json) << nlohmann::json{{"flip", mean}}.dump() << '\n';
  return Done{};
}

}  // namespace

// NOLINTNEXTLINE(bugprone-exception-escape): it may end the benchmark.
int main(int argc, char** argv) {
  CLI::App program("Writes the pictures and the depth that a museum gets for a list of views.");
  PicturesOptions options;
  program.add_option("scene", options.scene, "The scene")->required();
  program.add_option("--views", options.views, "File with a line for each: NAME X Y Z HEADING-DEG TILT-DEG SCALE")
      ->required();
  program.add_option("--out", options.out, "Folder for NAME (JPEG) and NAME.depth (16 bits for each 4x4 pixels)")
      ->required();
  program.add_option("--json", options.json, "File for the error that watermark and warp make")->required();
  program.add_option("--light", options.light, "File of stored light");
  program.add_option("--width", options.width, "Of the pictures, in pixels")->capture_default_str();
  program.add_option("--height", options.height, "Of the pictures, in pixels")->capture_default_str();
  program.add_option("--field-deg", options.field_deg, "Their width")->capture_default_str();
  program.add_option("--samples", options.samples, "Per pixel")->capture_default_str();
  program.add_option("--quality", options.quality, "Of the JPEG")->capture_default_str();
  program.add_option("--watermark", options.watermark, "Key of the museum; 0: none")->capture_default_str();
  program.add_option("--warp-px", options.warp_px, "Smooth displacement of the session, root mean square")
      ->capture_default_str();
  program.add_option("--warp-seed", options.warp_seed, "Another session has another one")->capture_default_str();
  CLI11_PARSE(program, argc, argv);
  const Status done = write_pictures(options);
  if (done) return 0;
  fmt::print(stderr, "{}\n", done.error().message());
  return 1;
}
