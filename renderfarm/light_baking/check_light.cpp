// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light_baking/check_light.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/image/colour.h"
#include "renderfarm/light_baking/visible_triangles.h"
#include "renderfarm/quality/flip.h"
#include "renderfarm/quality/split_reference.h"
#include "renderfarm/render/tone.h"

namespace cyclorama::light_baking {
namespace {

/// Seed of the held-out eyes; the baker's eyes have a different one.
constexpr std::uint64_t kHeldOutSeed = 4711;
constexpr double kSpan = 150.0 * std::numbers::pi / 180.0;
constexpr std::uint64_t kReferenceSeed = 1'000'001;

/// Largest difference between two pictures, in codes of the display, and its position.
struct WorstBlock {
  float codes = 0.0f;
  int x = 0;
  int y = 0;
};

WorstBlock worst_block(const RadianceImage& picture, const RadianceImage& reference, scene::ToneCurve tone) {
  WorstBlock worst;
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      for (int c = 0; c < RadianceImage::kChannels; ++c) {
        const auto shown = [&](const RadianceImage& image) {
          return 255.0f * linear_to_srgb(render::tone_mapped(image.at(x, y)[c], tone));
        };
        const float codes = std::abs(shown(picture) - shown(reference));
        if (codes > worst.codes) worst = {codes, x, y};
      }
    }
  }
  return worst;
}

class Checker {
 public:
  Checker(const render::Renderer& renderer, const CheckSettings& settings, const std::function<bool()>& cancelled)
      : renderer_(renderer), settings_(settings), cancelled_(cancelled) {}

  Status look_from(const Eigen::Vector3d& eye, int number) {
    view_ = held_out_view(renderer_.scene().info, eye, number, settings_.width, settings_.height);
    quality::SplitReference reference;
    const double paths_before = paths_cpu_seconds_;
    TRY(render(settings_.reference_samples, kReferenceSeed, &reference.a));
    TRY(render(settings_.reference_samples, kReferenceSeed + 1, &reference.b));
    const double paths = paths_cpu_seconds_ - paths_before;
    view_.quality.stored_light = true;
    RadianceImage picture;
    TRY(render(settings_.samples, 1, &picture));
    relmse_.push_back(static_cast<float>(quality::unbiased_relmse(picture, reference)));
    const RadianceImage blocks = quality::block_means(picture, kCheckedBlockPx);
    const quality::SplitReference reference_blocks = quality::block_means(reference, kCheckedBlockPx);
    block_relmse_.push_back(static_cast<float>(quality::unbiased_relmse(blocks, reference_blocks)));
    const RadianceImage mean = quality::mean_of(reference);
    const scene::ToneCurve tone = renderer_.scene().tone;
    TRY_ASSIGN(const quality::Flip flip,
               quality::flip(render::developed(picture, tone), render::developed(mean, tone)));
    flip_.push_back(static_cast<float>(flip.mean));
    light_ += quality::mean_value(picture);
    reference_light_ += quality::mean_value(mean);
    // The relMSE of path tracing is inversely proportional to the number of paths, so error times cost is constant.
    error_times_cost_ += quality::half_relmse(reference) * paths / 2.0;
    if (block_relmse_.back() >= *std::ranges::max_element(block_relmse_)) {
      const WorstBlock worst = worst_block(blocks, quality::mean_of(reference_blocks), tone);
      check_.worst_eye = {static_cast<float>(eye.x()), static_cast<float>(eye.y()), static_cast<float>(eye.z())};
      check_.worst_heading_rad = static_cast<float>(view_.heading_rad);
      check_.worst_codes = worst.codes;
      check_.worst_block_px = {static_cast<std::uint32_t>(worst.x * kCheckedBlockPx),
                               static_cast<std::uint32_t>(worst.y * kCheckedBlockPx)};
    }
    return Done{};
  }

  [[nodiscard]] CheckedLight result() {
    check_.eyes = static_cast<std::uint32_t>(relmse_.size());
    check_.reference_samples = static_cast<std::uint32_t>(2 * settings_.reference_samples);
    check_.relmse = light::percentiles_of(relmse_);
    check_.block_relmse = light::percentiles_of(block_relmse_);
    check_.flip = light::percentiles_of(flip_);
    check_.bias = reference_light_ > 0.0 ? static_cast<float>(light_ / reference_light_ - 1.0) : 0.0f;
    check_.relmse_of_paths = stored_cpu_seconds_ > 0.0 ? static_cast<float>(error_times_cost_ / stored_cpu_seconds_)
                                                       : std::numeric_limits<float>::max();
    check_.picture_width_px = static_cast<std::uint32_t>(settings_.width);
    check_.picture_height_px = static_cast<std::uint32_t>(settings_.height);
    const double mpx = 1e-6 * settings_.width * settings_.height * static_cast<double>(relmse_.size());
    const double samples_share = settings_.samples / (2.0 * settings_.reference_samples);
    return {check_, paths_cpu_seconds_ + stored_cpu_seconds_, stored_cpu_seconds_ / mpx,
            samples_share * paths_cpu_seconds_ / mpx};
  }

 private:
  Status render(int samples, std::uint64_t seed, RadianceImage* ret_picture) {
    view_.seed = seed;
    view_.quality.samples = samples;
    view_.quality.bounces = renderer_.scene().bounces;
    const render::RenderCost cost =
        renderer_.render_radiance(view_, {0, 0, settings_.width, settings_.height}, ret_picture, cancelled_);
    if (cancelled_ && cancelled_()) return Error(ErrorCode::kUnavailable, "checking the light was cancelled");
    (view_.quality.stored_light ? stored_cpu_seconds_ : paths_cpu_seconds_) += cost.cpu_seconds;
    return Done{};
  }

  const render::Renderer& renderer_;
  const CheckSettings& settings_;
  const std::function<bool()>& cancelled_;
  render::PanoramaView view_;
  light::LightCheck check_;
  std::vector<float> relmse_;
  std::vector<float> block_relmse_;
  std::vector<float> flip_;
  double light_ = 0.0;
  double reference_light_ = 0.0;
  double error_times_cost_ = 0.0;  ///< Sum over the eyes of relMSE times the processor seconds of path tracing.
  double paths_cpu_seconds_ = 0.0;
  double stored_cpu_seconds_ = 0.0;
};

}  // namespace

std::vector<Eigen::Vector3d> held_out_eyes(const scene::SceneInfo& info, int count) {
  std::vector<Eigen::Vector3d> eyes = walkable_eyes(info, count + 1, kHeldOutSeed);
  if (eyes.size() > 1) eyes.erase(eyes.begin());  // The start is also one of the baker's eyes.
  return eyes;
}

render::PanoramaView held_out_view(const scene::SceneInfo& info, const Eigen::Vector3d& eye, int i, int width,
                                   int height) {
  constexpr double kGoldenAngle = 2.399963;
  render::PanoramaView view;
  view.eye = eye;
  view.heading_rad = std::remainder(info.start_heading_rad + kGoldenAngle * i, 2.0 * std::numbers::pi);
  const double tan_half = 0.5 * kSpan * height / width;
  view.panorama = {width, height, kSpan, tan_half, -tan_half};
  return view;
}

Result<CheckedLight> check_light(const render::Renderer& renderer, const CheckSettings& settings,
                                 const std::function<void(double)>& progress, const std::function<bool()>& cancelled) {
  Checker checker(renderer, settings, cancelled);
  const std::vector<Eigen::Vector3d> eyes = held_out_eyes(renderer.scene().info, settings.eyes);
  for (std::size_t i = 0; i < eyes.size(); ++i) {
    TRY(checker.look_from(eyes[i], static_cast<int>(i)));
    if (progress) progress(static_cast<double>(i + 1) / static_cast<double>(eyes.size()));
  }
  return checker.result();
}

}  // namespace cyclorama::light_baking
