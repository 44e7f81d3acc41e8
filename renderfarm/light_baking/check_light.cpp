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

/// Contribution of one eye to the check.
struct CheckedEye {
  float relmse = 0.0f;
  float block_relmse = 0.0f;
  float flip = 0.0f;
  double light = 0.0;
  double reference_light = 0.0;
  double error_times_cost = 0.0;  ///< relMSE times processor seconds of paths.
  double paths_cpu_seconds = 0.0;
  double stored_cpu_seconds = 0.0;
  WorstBlock worst;
};

PieceBytes bytes_of(const CheckedEye& eye) {
  const auto& [relmse, block_relmse, flip, light, reference_light, error_times_cost, paths, stored, worst] = eye;
  PieceWriter out;
  for (const float value : {relmse, block_relmse, flip, worst.codes}) out.add(value);
  for (const double value : {light, reference_light, error_times_cost, paths, stored}) out.add(value);
  for (const int value : {worst.x, worst.y}) out.add(value);
  return out.take();
}

Result<CheckedEye> parse_eye(std::span<const std::byte> bytes) {
  CheckedEye eye;
  auto& [relmse, block_relmse, flip, light, reference_light, error_times_cost, paths, stored, worst] = eye;
  PieceReader in(bytes);
  for (float* const value : {&relmse, &block_relmse, &flip, &worst.codes}) *value = in.read<float>();
  for (double* const value : {&light, &reference_light, &error_times_cost, &paths, &stored}) *value = in.read<double>();
  for (int* const value : {&worst.x, &worst.y}) *value = in.read<int>();
  TRY(in.finished());
  return eye;
}

/// Looks from one eye. Thread-bound.
class EyeChecker {
 public:
  EyeChecker(const render::Renderer& renderer, const CheckSettings& settings, const std::function<bool()>& cancelled,
             const render::PanoramaView& view)
      : renderer_(renderer), settings_(settings), cancelled_(cancelled), view_(view) {}

  Result<CheckedEye> run() {
    quality::SplitReference reference;
    TRY(render(settings_.reference_samples, kReferenceSeed, &reference.a));
    TRY(render(settings_.reference_samples, kReferenceSeed + 1, &reference.b));
    view_.quality.stored_light = true;
    RadianceImage picture;
    TRY(render(settings_.samples, 1, &picture));
    eye_.relmse = static_cast<float>(quality::unbiased_relmse(picture, reference));
    const RadianceImage blocks = quality::block_means(picture, kCheckedBlockPx);
    const quality::SplitReference reference_blocks = quality::block_means(reference, kCheckedBlockPx);
    eye_.block_relmse = static_cast<float>(quality::unbiased_relmse(blocks, reference_blocks));
    const RadianceImage mean = quality::mean_of(reference);
    const scene::ToneCurve tone = renderer_.scene().tone;
    TRY_ASSIGN(const quality::Flip flip,
               quality::flip(render::developed(picture, tone), render::developed(mean, tone)));
    eye_.flip = static_cast<float>(flip.mean);
    eye_.light = quality::mean_value(picture);
    eye_.reference_light = quality::mean_value(mean);
    // The relMSE of paths falls with their number, so error times cost is a constant.
    eye_.error_times_cost = quality::half_relmse(reference) * eye_.paths_cpu_seconds / 2.0;
    eye_.worst = worst_block(blocks, quality::mean_of(reference_blocks), tone);
    return eye_;
  }

 private:
  Status render(int samples, std::uint64_t seed, RadianceImage* ret_picture) {
    view_.seed = seed;
    view_.quality.samples = samples;
    view_.quality.bounces = renderer_.scene().bounces;
    const render::RenderCost cost =
        renderer_.render_radiance(view_, {0, 0, settings_.width, settings_.height}, ret_picture, cancelled_);
    if (cancelled_ && cancelled_()) return Error(ErrorCode::kUnavailable, "checking the light was cancelled");
    (view_.quality.stored_light ? eye_.stored_cpu_seconds : eye_.paths_cpu_seconds) += cost.cpu_seconds;
    return Done{};
  }

  const render::Renderer& renderer_;
  const CheckSettings& settings_;
  const std::function<bool()>& cancelled_;
  render::PanoramaView view_;
  CheckedEye eye_;
};

CheckedLight summary_of(std::span<const CheckedEye> eyes, std::span<const render::PanoramaView> views,
                        const CheckSettings& settings) {
  std::vector<float> relmse;
  std::vector<float> block_relmse;
  std::vector<float> flip;
  CheckedEye sum;
  light::LightCheck check;
  for (std::size_t i = 0; i < eyes.size(); ++i) {
    const CheckedEye& eye = eyes[i];
    relmse.push_back(eye.relmse);
    block_relmse.push_back(eye.block_relmse);
    flip.push_back(eye.flip);
    sum.light += eye.light;
    sum.reference_light += eye.reference_light;
    sum.error_times_cost += eye.error_times_cost;
    sum.paths_cpu_seconds += eye.paths_cpu_seconds;
    sum.stored_cpu_seconds += eye.stored_cpu_seconds;
    if (eye.block_relmse < *std::ranges::max_element(block_relmse)) continue;
    const Eigen::Vector3f position = views[i].eye.cast<float>();
    check.worst_eye = {position.x(), position.y(), position.z()};
    check.worst_heading_rad = static_cast<float>(views[i].heading_rad);
    check.worst_codes = eye.worst.codes;
    check.worst_block_px = {static_cast<std::uint32_t>(eye.worst.x * kCheckedBlockPx),
                            static_cast<std::uint32_t>(eye.worst.y * kCheckedBlockPx)};
  }
  check.eyes = static_cast<std::uint32_t>(eyes.size());
  check.reference_samples = static_cast<std::uint32_t>(2 * settings.reference_samples);
  check.relmse = light::percentiles_of(relmse);
  check.block_relmse = light::percentiles_of(block_relmse);
  check.flip = light::percentiles_of(flip);
  check.bias = sum.reference_light > 0.0 ? static_cast<float>(sum.light / sum.reference_light - 1.0) : 0.0f;
  check.relmse_of_paths = sum.stored_cpu_seconds > 0.0
                              ? static_cast<float>(sum.error_times_cost / sum.stored_cpu_seconds)
                              : std::numeric_limits<float>::max();
  check.picture_width_px = static_cast<std::uint32_t>(settings.width);
  check.picture_height_px = static_cast<std::uint32_t>(settings.height);
  const double mpx = 1e-6 * settings.width * settings.height * static_cast<double>(eyes.size());
  const double samples_share = settings.samples / (2.0 * settings.reference_samples);
  return {check, sum.paths_cpu_seconds + sum.stored_cpu_seconds, sum.stored_cpu_seconds / mpx,
          samples_share * sum.paths_cpu_seconds / mpx};
}

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
                                 const std::function<void(double)>& progress, const std::function<bool()>& cancelled,
                                 StageChain& stages) {
  const std::vector<Eigen::Vector3d> eyes = held_out_eyes(renderer.scene().info, settings.eyes);
  std::vector<render::PanoramaView> views;
  for (std::size_t i = 0; i < eyes.size(); ++i) {
    views.push_back(
        held_out_view(renderer.scene().info, eyes[i], static_cast<int>(i), settings.width, settings.height));
  }
  const PieceCut cut(eyes.size(), 1);
  std::vector<CheckedEye> checked(eyes.size());
  std::size_t taken = 0;
  StageWork work;
  work.in_parallel = false;  // A picture uses all threads of the renderer.
  work.compute = [&](std::uint32_t piece) -> Result<PieceBytes> {
    PieceBytes bytes;
    for (std::size_t i = cut.first(piece); i < cut.end(piece); ++i) {
      TRY_ASSIGN(const CheckedEye eye, EyeChecker(renderer, settings, cancelled, views[i]).run());
      const PieceBytes more = bytes_of(eye);
      bytes.insert(bytes.end(), more.begin(), more.end());
    }
    return bytes;
  };
  work.take = [&](std::uint32_t piece, std::span<const std::byte> bytes) -> Status {
    const std::size_t count = cut.end(piece) - cut.first(piece);
    const std::size_t bytes_each = bytes.size() / count;
    for (std::size_t i = 0; i < count; ++i) {
      TRY_ASSIGN(checked[cut.first(piece) + i], parse_eye(bytes.subspan(i * bytes_each, bytes_each)));
    }
    taken += count;
    if (progress) progress(static_cast<double>(taken) / static_cast<double>(eyes.size()));
    return Done{};
  };
  TRY(stages.complete(cut.pieces(), std::move(work)));
  return summary_of(checked, views, settings);
}

Result<CheckedLight> check_light(const render::Renderer& renderer, const CheckSettings& settings,
                                 const std::function<void(double)>& progress, const std::function<bool()>& cancelled) {
  ComputedPieces here;
  StageChain stages(here);
  return check_light(renderer, settings, progress, cancelled, stages);
}

}  // namespace cyclorama::light_baking
