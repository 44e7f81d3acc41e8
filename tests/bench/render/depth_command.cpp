// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/depth_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numbers>
#include <vector>

#include "common/base/cpu_time.h"
#include "common/base/percentiles.h"
#include "common/base/picture_cut.h"
#include "common/image/cropped.h"
#include "common/image/inverse_depth.h"
#include "common/image/jpeg.h"
#include "renderfarm/balance/tiles.h"
#include "renderfarm/denoise/denoising_renderer.h"
#include "renderfarm/tools/view_options.h"

namespace cyclorama {
namespace {

/// Samples of moving pictures, which are denoised; see governor::ParetoFront::standard().
constexpr int kDepthSamples[] = {1, 2, 4, 8, 16};
/// Pictures are cut into this many blocks beside each other, one for each node, and these into tiles.
constexpr int kDepthBlocks[] = {1, 4, 16};
constexpr int kDepthHeadings = 4;

struct DepthCommandOptions {
  tools::SceneOptions scene;
  tools::ViewOptions view;
  std::string json;
  int pairs = 12;
  std::optional<int> bounces;
};

/// Sums over the frames.
struct DepthBytes {
  std::size_t jpeg = 0;
  std::size_t depth = 0;
  double jpeg_s = 0.0;
  double depth_s = 0.0;

  [[nodiscard]] double share() const { return static_cast<double>(depth) / static_cast<double>(jpeg); }
};

class DepthMeasurement {
 public:
  DepthMeasurement(const render::Renderer& renderer, const render::PanoramaView& view, const StopSignal& stop)
      : renderer_(renderer),
        denoising_(renderer),
        view_(view),
        whole_{0, 0, view.panorama.width_px, view.panorama.height_px},
        stop_(stop) {}

  /// Returns the sums over the headings for each of kDepthBlocks.
  Result<std::vector<DepthBytes>> bytes(int samples) {
    std::vector<DepthBytes> sums(std::size(kDepthBlocks));
    for (int i = 0; i < kDepthHeadings; ++i) {
      const render::PanoramaView view = turned(i, samples, true);
      RgbImage picture;
      InverseDepthImage depth;
      denoising_.render(view, whole_, &picture, cancelled(), &depth);
      if (stop_.requested()) return tools::stopped();
      for (std::size_t k = 0; k < sums.size(); ++k) TRY(add_tiles(picture, depth, kDepthBlocks[k], &sums[k]));
    }
    return sums;
  }

  /// Returns the thread time of a frame with depth over that of the same frame without, for `pairs` pairs. The order
  /// alternates, so that a change of the machine's speed favours neither.
  Result<Percentiles> cost_ratio(int pairs) {
    Percentiles ratios;
    for (int i = 0; i < pairs; ++i) {
      double seconds[2] = {};
      for (const bool second : {false, true}) {
        const bool with_depth = second == (i % 2 == 0);
        RgbImage picture;
        InverseDepthImage depth;
        seconds[with_depth ? 1 : 0] =
            renderer_.render(turned(i, 1, with_depth), whole_, &picture, cancelled(), &depth).cpu_seconds;
      }
      if (stop_.requested()) return tools::stopped();
      ratios.add(seconds[1] / seconds[0]);
    }
    return ratios;
  }

 private:
  [[nodiscard]] std::function<bool()> cancelled() const {
    return [this] { return stop_.requested(); };
  }
  [[nodiscard]] render::PanoramaView turned(int index, int samples, bool depth) const {
    render::PanoramaView view = view_;
    view.heading_rad += 2.0 * std::numbers::pi * index / kDepthHeadings;
    view.seed = static_cast<std::uint64_t>(index);
    view.quality.samples = samples;
    view.depth = depth;
    return view;
  }
  Status add_tiles(const RgbImage& picture, const InverseDepthImage& depth, int blocks, DepthBytes* sum) {
    const int cells = whole_.width / kCutPx;
    for (int i = 0; i < blocks; ++i) {
      const int left = cells * i / blocks * kCutPx;
      const int right = i + 1 == blocks ? whole_.width : cells * (i + 1) / blocks * kCutPx;
      for (const PixelRect& tile : balance::tiles_of({left, 0, right - left, whole_.height})) {
        double start = thread_cpu_seconds();
        TRY_ASSIGN(const std::vector<std::byte> jpeg, encoder_.encode(cropped(picture, tile), JpegOptions{}));
        sum->jpeg_s += thread_cpu_seconds() - start;
        sum->jpeg += jpeg.size();
        start = thread_cpu_seconds();
        sum->depth += encode_inverse_depth(cropped(depth, depth_cells(tile))).size();
        sum->depth_s += thread_cpu_seconds() - start;
      }
    }
    return Done{};
  }

  const render::Renderer& renderer_;
  denoise::DenoisingRenderer denoising_;
  const render::PanoramaView view_;
  const PixelRect whole_;
  const StopSignal& stop_;
  JpegEncoder encoder_;
};

Status run_depth(const DepthCommandOptions& options, const StopSignal& stop) {
  TRY_ASSIGN(tools::LoadedScene loaded, tools::load_with_progress(options.scene));
  TRY_ASSIGN(render::PanoramaView view, tools::panorama_view_of(options.view, loaded.scene.info));
  view.quality.bounces = options.bounces.value_or(loaded.scene.bounces);
  if (stop.requested()) return tools::stopped();
  TRY_ASSIGN(const std::unique_ptr<render::Renderer> renderer,
             tools::build_with_progress(std::move(loaded.scene), options.scene));
  DepthMeasurement measurement(*renderer, view, stop);
  nlohmann::json points = nlohmann::json::array();
  double largest_share = 0.0;
  fmt::print("Means of {} headings, {} at quality {}\n", kDepthHeadings, options.view.size, JpegOptions{}.quality);
  fmt::print("samples  blocks  JPEG kB  depth kB    share  encode ms: JPEG  depth\n");
  for (const int samples : kDepthSamples) {
    TRY_ASSIGN(const std::vector<DepthBytes> sums, measurement.bytes(samples));
    for (std::size_t k = 0; k < sums.size(); ++k) {
      const DepthBytes& sum = sums[k];
      largest_share = std::max(largest_share, sum.share());
      fmt::print("{:>7} {:>7} {:>8.1f} {:>9.1f} {:>6.1f} % {:>16.2f} {:>6.2f}\n", samples, kDepthBlocks[k],
                 1e-3 * static_cast<double>(sum.jpeg) / kDepthHeadings,
                 1e-3 * static_cast<double>(sum.depth) / kDepthHeadings, 100.0 * sum.share(),
                 1e3 * sum.jpeg_s / kDepthHeadings, 1e3 * sum.depth_s / kDepthHeadings);
      points.push_back({{"samples", samples},
                        {"blocks", kDepthBlocks[k]},
                        {"jpeg_bytes", sum.jpeg / kDepthHeadings},
                        {"depth_bytes", sum.depth / kDepthHeadings},
                        {"share", sum.share()},
                        {"jpeg_encode_ms", 1e3 * sum.jpeg_s / kDepthHeadings},
                        {"depth_encode_ms", 1e3 * sum.depth_s / kDepthHeadings}});
    }
  }
  TRY_ASSIGN(const Percentiles ratios, measurement.cost_ratio(options.pairs));
  fmt::print("largest share {:.1f} %; rendering with depth takes {:.4f} times the time without (median of {} pairs)\n",
             100.0 * largest_share, ratios.at(0.5), options.pairs);
  if (options.json.empty()) return Done{};
  return tools::write_json(options.json, {{"points", points},
                                          {"largest_share", largest_share},
                                          {"cost_ratio", ratios.at(0.5)},
                                          {"cost_ratio_p25", ratios.at(0.25)},
                                          {"cost_ratio_p75", ratios.at(0.75)}});
}

}  // namespace

tools::RenderCommand add_depth_command(CLI::App* program) {
  CLI::App* const parser =
      program->add_subcommand("depth-bytes", "What inverse depth adds to a scene's frames: bytes, processor time");
  const auto options = std::make_shared<DepthCommandOptions>();
  options->view.camera.field_deg = 150.0;
  tools::add_scene_options(parser, &options->scene);
  tools::add_view_options(parser, &options->view);
  parser
      ->add_option("--bounces", options->bounces,
                   "Times that light goes from surface to surface; the scene's if left out")
      ->check(CLI::Range(0, render::kMaxBounces));
  parser->add_option("--pairs", options->pairs, "Frames of one sample rendered with depth and without")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  parser->add_option("--json", options->json, "Also write the figures as JSON");
  return {parser, [options](const StopSignal& stop) { return run_depth(*options, stop); }};
}

}  // namespace cyclorama
