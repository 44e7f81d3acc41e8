// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light_baking/light_tracer.h"

#include <limits>

#include "common/base/check.h"
#include "renderfarm/render/sampler.h"
#include "renderfarm/render/shade.h"

namespace cyclorama::light_baking {
namespace {

using render::Vec3;

/// Shadow rays of a point between two checks of their agreement.
constexpr int kRound = 16;
/// Dimensions of the random numbers; see sampler.h.
enum Dimension : std::uint32_t { kLampChoice = 1000, kLampPlace, kDirection, kPathSeed };

/// Returns the light that a path found; nothing if it is not finite.
Vec3 light_of(const render::Path& path) {
  const Vec3 light = path.direct + path.indirect;
  return light.hasNaN() ? Vec3(Vec3::Zero()) : Vec3(light.cwiseMin(render::kBrightest));
}

/// Minimum standard error of stratified samples, as a share of that of independent ones.
constexpr double kMinShare = 0.15;

/// The mean of samples that come in rounds. Each round is stratified, so the error is estimated from the scatter of the
/// rounds' means; that of the samples would overestimate it.
struct Estimate {
  Vec3 sum = Vec3::Zero();
  Vec3 direction = Vec3::Zero();
  Vec3 round = Vec3::Zero();
  double rounds = 0.0;   ///< Sum of the rounds' luminances.
  double squares = 0.0;  ///< Sum of their squares.
  double sample_squares = 0.0;
  int count = 0;  ///< Rounds.

  void add(const Vec3& light, const Vec3& from) {
    round += light;
    direction += render::luminance(light) * from;
    const auto value = static_cast<double>(render::luminance(light));
    sample_squares += value * value;
  }
  void end_round() {
    sum += round;
    const auto value = static_cast<double>(render::luminance(round)) / kRound;
    rounds += value;
    squares += value * value;
    round.setZero();
    ++count;
  }
  [[nodiscard]] double mean() const { return rounds / count; }
  [[nodiscard]] double error() const {
    if (count < 2) return std::numeric_limits<double>::infinity();
    const double of_rounds = std::sqrt(std::max(0.0, squares / count - mean() * mean()) / (count - 1));
    // A few rounds may agree by chance.
    const int samples = count * kRound;
    const double of_samples = std::sqrt(std::max(0.0, sample_squares / samples - mean() * mean()) / samples);
    return std::max(of_rounds, kMinShare * of_samples);
  }
  [[nodiscard]] LampLight result() const {
    if (count == 0) return {};
    const auto samples = static_cast<float>(count * kRound);
    return {sum / samples, direction / samples, count < 2 ? 0.0f : static_cast<float>(error())};
  }
};

}  // namespace

LightTracer::LightTracer(const render::TraceScene& scene, render::ShadeStage shade, int bounces)
    : scene_(scene),
      shade_(shade),
      batch_(std::make_unique<render::PathBatch>()),
      directions_(render::kMaxRays, Vec3::Zero()),
      film_(std::make_unique<render::CellFilm>()) {
  view_.quality.bounces = bounces;
  view_.quality.stored_light = true;
  film_->clear();
}

void LightTracer::add_light_ray(const LightPoint& point, std::uint32_t number, std::size_t path) {
  const std::uint32_t index = render::reversed_bits(number);
  const float choice = render::sobol_value(index, point.seed, kLampChoice);
  const render::SobolPoint place = render::sobol_point(index, point.seed, kLampPlace);
  render::LightSample aim;
  if (!scene_.lights.sample(point.position, point.normal, choice, {place.u, place.v}, &aim)) return;
  const float cosine = point.normal.dot(aim.direction);
  if (!(cosine > 0.0f && point.facing.dot(aim.direction) > 0.0f)) return;
  directions_[path] = aim.direction;
  const float density = cosine / render::kPi;
  float share = 1.0f;
  if (aim.pdf > 0.0f) share = render::share_of(aim.pdf, density);
  batch_->shadowed[static_cast<std::size_t>(batch_->shadow_rays.count())] = {aim.radiance_over_pdf * (density * share),
                                                                             static_cast<std::uint16_t>(path), true};
  batch_->shadow_rays.add(point.position, aim.direction, aim.distance,
                          render::alpha_random_number(index, point.seed, 1));
}

void LightTracer::from_lamps(std::span<const LightPoint> points, const TracerSettings& settings,
                             std::span<LampLight> ret) {
  constexpr std::size_t kTogether = render::kMaxRays / kRound;
  std::vector<Estimate> estimates(points.size());
  std::vector<std::size_t> active;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].exists()) active.push_back(i);
  }
  for (int done = 0; done < settings.max_light_rays && !active.empty(); done += kRound) {
    for (std::size_t first = 0; first < active.size(); first += kTogether) {
      const std::size_t end = std::min(first + kTogether, active.size());
      for (std::size_t path = 0; path < (end - first) * kRound; ++path) batch_->path[path] = render::Path{};
      for (std::size_t path = 0; path < (end - first) * kRound; ++path) {
        add_light_ray(points[active[first + path / kRound]],
                      static_cast<std::uint32_t>(done) + static_cast<std::uint32_t>(path % kRound), path);
      }
      render::trace_shadows(scene_, *batch_);
      for (std::size_t path = 0; path < (end - first) * kRound; ++path) {
        estimates[active[first + path / kRound]].add(light_of(batch_->path[path]), directions_[path]);
      }
    }
    std::erase_if(active, [&](std::size_t i) {
      estimates[i].end_round();
      return estimates[i].error() <= static_cast<double>(settings.light_error) * estimates[i].mean();
    });
  }
  for (std::size_t i = 0; i < points.size(); ++i) ret[i] = estimates[i].result();
}

void LightTracer::from_surfaces(std::span<const LightPoint> points, int rays, bool only_lamps,
                                std::span<GatheredLight> ret) {
  CHECK(rays >= 1 && rays <= render::kMaxRays && (rays & (rays - 1)) == 0);
  const std::size_t together = static_cast<std::size_t>(render::kMaxRays / rays);
  const auto per_point = static_cast<std::size_t>(rays);
  // Distant textures are averaged over the solid angle of a ray.
  const float spread = std::sqrt(2.0f * render::kPi / static_cast<float>(rays));
  for (std::size_t first = 0; first < points.size(); first += together) {
    const std::size_t count = std::min(together, points.size() - first);
    batch_->stage = 0;
    for (std::size_t i = 0; i < count * per_point; ++i) {
      const LightPoint& point = points[first + i / per_point];
      const std::uint32_t index = render::reversed_bits(static_cast<std::uint32_t>(i % per_point));
      render::Path& path = batch_->path[i];
      path = render::Path{};
      path.index_reversed = index;
      path.seed = render::mix_bits(point.seed ^ kPathSeed);
      if (!point.exists()) continue;
      const render::SobolPoint u = render::sobol_point(index, point.seed, kDirection);
      const Vec3 direction = render::from_frame_of(point.normal, render::cosine_hemisphere({u.u, u.v}));
      if (!(point.facing.dot(direction) > 0.0f)) continue;
      render::RayStage& stage = batch_->current();
      render::PathRay& ray = stage.state[static_cast<std::size_t>(stage.rays.count())];
      ray = render::PathRay{};
      directions_[i] = direction;
      ray.pdf = std::max(0.0f, point.normal.dot(direction)) / render::kPi;
      ray.from_normal = point.normal;
      ray.cone_spread = spread;
      ray.path = static_cast<std::uint16_t>(i);
      ray.scatterings = 1;
      ray.surfaces = 1;
      ray.aimed_surfaces = 1;
      ray.only_light = only_lamps;
      stage.rays.add(point.position, direction, std::numeric_limits<float>::infinity(),
                     render::alpha_random_number(index, point.seed, 2));
    }
    render::trace_paths(scene_, shade_, view_, render::Coherence::kIncoherent, *batch_, *film_);
    for (std::size_t p = 0; p < count; ++p) {
      GatheredLight sum;
      for (std::size_t i = p * per_point; i < (p + 1) * per_point; ++i) {
        const Vec3 light = light_of(batch_->path[i]);
        sum.light += light;
        sum.direction += render::luminance(light) * directions_[i];
      }
      ret[first + p] = {sum.light / static_cast<float>(rays), sum.direction / static_cast<float>(rays)};
    }
  }
}

void LightTracer::find_visible(std::span<const std::array<Vec3, 2>> pairs, std::span<std::uint8_t> ret) {
  for (std::size_t first = 0; first < pairs.size(); first += render::kMaxRays) {
    const std::size_t count = std::min<std::size_t>(render::kMaxRays, pairs.size() - first);
    for (std::size_t i = 0; i < count; ++i) {
      batch_->path[i] = render::Path{};
      const Vec3 way = pairs[first + i][1] - pairs[first + i][0];
      batch_->shadowed[i] = {Vec3::Ones(), static_cast<std::uint16_t>(i), true};
      batch_->shadow_rays.add(pairs[first + i][0], way, 1.0f, 0);
    }
    render::trace_shadows(scene_, *batch_);
    for (std::size_t i = 0; i < count; ++i) ret[first + i] = batch_->path[i].direct.x() > 0.0f ? 1 : 0;
  }
}

}  // namespace cyclorama::light_baking
