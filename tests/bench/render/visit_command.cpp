// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/visit_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <vector>

#include "common/image/jpeg.h"
#include "common/process/progress.h"
#include "renderfarm/denoise/denoising_renderer.h"
#include "renderfarm/light/light_file.h"
#include "renderfarm/node/block_view.h"
#include "renderfarm/quality/flip.h"
#include "renderfarm/quality/split_reference.h"
#include "renderfarm/render/tone.h"
#include "tests/support/view_text.h"

namespace cyclorama {
namespace {

/// Parts of the wall's picture that are compared: a whole reference of full size would take an hour.
constexpr int kPartPx = 64;

struct VisitOptions {
  tools::SceneOptions scene;
  std::string views;
  std::string json;
  int width = 1920;
  int height = 1080;
  int parts = 8;
  int reference_samples = 64;
};

struct Errors {
  double relmse = 0.0;
  double flip = 0.0;
};

/// A view as its frame was rendered, whole.
struct Frame {
  render::PanoramaView view;
  bool denoise = false;
  JpegOptions jpeg;
};

Result<std::vector<Frame>> read_frames(const std::string& path) {
  std::ifstream lines(path);
  std::vector<Frame> frames;
  for (std::string line; std::getline(lines, line);) {
    wire::RenderBlock block;
    const auto view = view_from_hex(line);
    if (!view) return Error(ErrorCode::kBadData, fmt::format("{}:{}: not a view", path, frames.size() + 1));
    *block.mutable_view() = *view;
    block.set_width_px(view->panorama().width_px());
    block.set_height_px(view->panorama().height_px());
    Frame frame;
    TRY_ASSIGN(frame.view, node::view_of(block));
    frame.denoise = view->denoise();
    frame.jpeg = node::jpeg_options_of(block);
    frames.push_back(frame);
  }
  if (frames.empty()) return Error(ErrorCode::kBadData, path + ": no views");
  return frames;
}

/// Returns a part of the wall's picture, interpolated between the pixels of a frame of fewer, as a display does.
/// `pixels` are those of the frame from `from` on; beyond them, the outermost are repeated.
RadianceImage shown(const RadianceImage& pixels, const PixelRect& from, const PixelRect& part, double scale_x,
                    double scale_y) {
  RadianceImage out(part.width, part.height);
  const auto split = [](double at, int size, int* first, int* second) {
    *first = std::clamp(static_cast<int>(std::floor(at)), 0, size - 1);
    *second = std::min(*first + 1, size - 1);
    return static_cast<float>(std::clamp(at - *first, 0.0, 1.0));
  };
  for (int y = 0; y < part.height; ++y) {
    for (int x = 0; x < part.width; ++x) {
      int x0 = 0, x1 = 0, y0 = 0, y1 = 0;
      const float u = split((part.x + x + 0.5) * scale_x - 0.5 - from.x, pixels.width(), &x0, &x1);
      const float v = split((part.y + y + 0.5) * scale_y - 0.5 - from.y, pixels.height(), &y0, &y1);
      for (int c = 0; c < 3; ++c) {
        out.at(x, y)[c] = std::lerp(std::lerp(pixels.at(x0, y0)[c], pixels.at(x1, y0)[c], u),
                                    std::lerp(pixels.at(x0, y1)[c], pixels.at(x1, y1)[c], u), v);
      }
    }
  }
  return out;
}

class FrameErrors {
 public:
  FrameErrors(const VisitOptions& options, const StopSignal& stop, const render::Renderer& renderer)
      : options_(options), renderer_(renderer), denoising_(renderer), stop_(stop) {}

  Result<Errors> of(const Frame& frame, const PixelRect& part) {
    TRY_ASSIGN(const RadianceImage picture, picture_of(frame, part));
    quality::SplitReference reference;
    std::uint64_t seed = 1'000'001;
    for (RadianceImage* const half : {&reference.a, &reference.b}) {
      render::PanoramaView view = frame.view;
      view.panorama.width_px = options_.width;
      view.panorama.height_px = options_.height;
      view.quality = {};
      view.quality.samples = options_.reference_samples;
      view.quality.bounces = renderer_.scene().bounces;
      view.seed = seed++;
      renderer_.render_radiance(view, part, half, [this] { return stop_.requested(); });
    }
    if (stop_.requested()) return tools::stopped();
    Errors errors;
    errors.relmse = quality::unbiased_relmse(picture, reference);
    const scene::ToneCurve tone = renderer_.scene().tone;
    const RgbImage codes = render::developed(picture, tone);
    TRY_ASSIGN(const std::vector<std::byte> jpeg, encoder_.encode(codes, frame.jpeg));
    TRY_ASSIGN(const RgbImage decoded, decoder_.decode(jpeg, codes.data().size()));
    TRY_ASSIGN(const quality::Flip flip, quality::flip(decoded, render::developed(quality::mean_of(reference), tone)));
    errors.flip = flip.mean;
    return errors;
  }

 private:
  Result<RadianceImage> picture_of(const Frame& frame, const PixelRect& part) {
    const Panorama& size = frame.view.panorama;
    const double scale_x = static_cast<double>(size.width_px) / options_.width;
    const double scale_y = static_cast<double>(size.height_px) / options_.height;
    const int left = std::max(0, static_cast<int>(part.x * scale_x) - 1);
    const int top = std::max(0, static_cast<int>(part.y * scale_y) - 1);
    const int right = std::min(size.width_px, static_cast<int>((part.x + part.width) * scale_x) + 2);
    const int bottom = std::min(size.height_px, static_cast<int>((part.y + part.height) * scale_y) + 2);
    const PixelRect from{left, top, right - left, bottom - top};
    RadianceImage pixels;
    const auto cancelled = [this] { return stop_.requested(); };
    if (frame.denoise) {
      denoising_.render_radiance(frame.view, from, &pixels, cancelled);
    } else {
      renderer_.render_radiance(frame.view, from, &pixels, cancelled);
    }
    if (stop_.requested()) return tools::stopped();
    return shown(pixels, from, part, scale_x, scale_y);
  }

  const VisitOptions& options_;
  const render::Renderer& renderer_;
  denoise::DenoisingRenderer denoising_;
  JpegEncoder encoder_;
  JpegDecoder decoder_;
  const StopSignal& stop_;
};

Status measure_visit(const VisitOptions& options, const StopSignal& stop) {
  TRY_ASSIGN(const std::vector<Frame> frames, read_frames(options.views));
  TRY_ASSIGN(tools::LoadedScene loaded, tools::load_with_progress(options.scene));
  TRY_ASSIGN(const std::unique_ptr<render::Renderer> renderer,
             tools::build_with_progress(std::move(loaded.scene), options.scene));
  const std::filesystem::path light = std::filesystem::path(options.scene.scene) / light::kLightFileName;
  if (std::filesystem::exists(light)) {
    TRY_ASSIGN(light::LightStore store, light::read_light_file(light));
    TRY(renderer->set_light(std::make_shared<light::LightStore>(std::move(store)), light.string()));
  }
  FrameErrors meter(options, stop, *renderer);
  Progress progress("comparing");
  std::mt19937 random(1);
  Errors mean;
  const double share = 1.0 / static_cast<double>(frames.size() * static_cast<std::size_t>(options.parts));
  double done = 0.0;
  for (const Frame& frame : frames) {
    for (int i = 0; i < options.parts; ++i) {
      const PixelRect part{std::uniform_int_distribution(0, options.width - kPartPx)(random),
                           std::uniform_int_distribution(0, options.height - kPartPx)(random), kPartPx, kPartPx};
      TRY_ASSIGN(const Errors errors, meter.of(frame, part));
      mean.relmse += share * errors.relmse;
      mean.flip += share * errors.flip;
      progress.update(done += share);
    }
  }
  fmt::print("{} frames, {} parts of {}x{} pixels each: relMSE {:.5f}, FLIP {:.4f}\n", frames.size(), options.parts,
             kPartPx, kPartPx, mean.relmse, mean.flip);
  if (options.json.empty()) return Done{};
  return tools::write_json(options.json, {{"relmse", mean.relmse}, {"flip", mean.flip}});
}

}  // namespace

tools::RenderCommand add_visit_command(CLI::App* program) {
  CLI::App* const parser =
      program->add_subcommand("visit", "Measure the error of a visit's frames against path traced references");
  const auto options = std::make_shared<VisitOptions>();
  tools::add_scene_options(parser, &options->scene);
  parser->add_option("--views", options->views, "A frame's view in hexadecimal on each line")->required();
  parser->add_option("--width", options->width, "Of the wall's picture, in pixels")->capture_default_str();
  parser->add_option("--height", options->height, "Of the wall's picture, in pixels")->capture_default_str();
  parser->add_option("--parts", options->parts, "Parts of each frame that are compared")->capture_default_str();
  parser->add_option("--reference-samples", options->reference_samples, "Samples of each half of the reference")
      ->capture_default_str();
  parser->add_option("--json", options->json, "Also write the figures as JSON");
  return {parser, [options](const StopSignal& stop) { return measure_visit(*options, stop); }};
}

}  // namespace cyclorama
