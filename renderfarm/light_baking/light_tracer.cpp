// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light_baking/light_tracer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "common/base/check.h"
#include "common/base/cpu_time.h"
#include "renderfarm/render/sampler.h"
#include "renderfarm/render/shade.h"

namespace cyclorama::light_baking {
namespace {

using render::Vec3;

/// Number of rays of a point in one round, after which their agreement is checked.
constexpr int kRound = 16;
/// Number of rays after which a point may be considered dark. The first rounds may miss a dim lamp next to bright ones
/// that are hidden; stopping early for such points would darken the mean.
constexpr int kMinDarkRays = 64;
/// Number of classes into which rays are sorted, so that similar rays are traced together.
constexpr std::size_t kParts = 64;
/// Dimensions of the random numbers; see sampler.h.
enum Dimension : std::uint32_t { kLampChoice = 1000, kLampPlace, kDirection, kPathSeed, kSite };

/// Returns the light that a path found; zero if it is not finite.
Vec3 light_of(const render::Path& path) {
  const Vec3 light = path.direct + path.indirect;
  return light.hasNaN() ? Vec3(Vec3::Zero()) : Vec3(light.cwiseMin(render::kBrightest));
}

/// Minimum standard error of stratified samples, as a fraction of that of independent samples.
constexpr double kMinShare = 0.15;

/// The mean of samples that come in rounds. Each round is stratified, so the error is estimated from the scatter of the
/// rounds' means; the scatter of the samples would overestimate it.
struct Estimate {
  Vec3 sum = Vec3::Zero();
  Vec3 direction = Vec3::Zero();
  Vec3 round = Vec3::Zero();
  double rounds = 0.0;   ///< Sum of the rounds' luminances.
  double squares = 0.0;  ///< Sum of the squares of the rounds' luminances.
  double sample_squares = 0.0;
  int count = 0;  ///< Number of rounds.

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
    if (count < 1) return std::numeric_limits<double>::infinity();
    const int samples = count * kRound;
    const double of_samples = std::sqrt(std::max(0.0, sample_squares / samples - mean() * mean()) / samples);
    if (count < 2) return of_samples;
    const double of_rounds = std::sqrt(std::max(0.0, squares / count - mean() * mean()) / (count - 1));
    // A few rounds may agree by chance.
    return std::max(of_rounds, kMinShare * of_samples);
  }
  /// Returns the result of `samples` samples in total, in rounds as far as there are enough.
  [[nodiscard]] GatheredLight gathered(int samples) const {
    const auto share = 1.0f / static_cast<float>(samples);
    return {share * (sum + round), share * direction, count < 1 ? 0.0f : static_cast<float>(error())};
  }
  [[nodiscard]] LampLight result() const {
    if (count == 0) return {};
    const auto samples = static_cast<float>(count * kRound);
    return {sum / samples, direction / samples, static_cast<float>(error())};
  }
};

}  // namespace

LightTracer::LightTracer(const render::TraceScene& scene, render::ShadeStage shade, std::function<bool()> must_end,
                         const scene::LampLevels& lamps)
    : scene_(scene),
      shade_(shade),
      must_end_(std::move(must_end)),
      batch_(std::make_unique<render::PathBatch>()),
      directions_(render::kMaxRays, Vec3::Zero()),
      starts_(render::kMaxRays),
      part_(render::kMaxRays),
      order_(render::kMaxRays),
      film_(std::make_unique<render::CellFilm>()) {
  view_.quality.stored_light = true;
  view_.max_stored_scatterings = 1;
  view_.lamps = lamps;
  film_->clear();
}

void LightTracer::begin_run() { run_began_ = thread_cpu_seconds(); }

bool LightTracer::must_end() {
  const double now = thread_cpu_seconds();
  max_run_ = std::max(max_run_, now - run_began_);
  run_began_ = now;
  return must_end_ && must_end_();
}

std::span<const std::uint16_t> LightTracer::by_part(std::size_t count) {
  std::array<std::uint16_t, kParts + 1> end{};
  for (std::size_t i = 0; i < count; ++i) ++end[part_[i] + 1u];
  for (std::size_t part = 0; part < kParts; ++part)
    end[part + 1] = static_cast<std::uint16_t>(end[part + 1] + end[part]);
  for (std::size_t i = 0; i < count; ++i) order_[end[part_[i]]++] = static_cast<std::uint16_t>(i);
  return std::span(order_).first(count);
}

void LightTracer::begin(const LightSpot& spot, std::uint32_t number, std::size_t path) {
  batch_->path[path] = render::Path{};
  Start& start = starts_[path];
  start.index = render::reversed_bits(number);
  start.seed = spot.seed;
  start.from = &spot.at(spot.points.size() == 1 ? 0.0f : render::sobol_value(start.index, spot.seed, kSite));
}

void LightTracer::add_light_ray(std::size_t path) {
  const Start& start = starts_[path];
  const LightPoint& point = *start.from;
  const render::SobolPoint place = render::sobol_point(start.index, start.seed, kLampPlace);
  render::LightSample aim;
  if (!scene_.lights.sample(point.position, point.normal, start.u, {place.u, place.v}, &aim)) return;
  const float cosine = point.normal.dot(aim.direction);
  if (!(cosine > 0.0f && point.facing.dot(aim.direction) > 0.0f)) return;
  directions_[path] = aim.direction;
  const float density = cosine / render::kPi;
  float share = 1.0f;
  if (aim.pdf > 0.0f) share = render::share_of(aim.pdf, density);
  const Vec3 light = aim.radiance_over_pdf * (density * share * view_.lamps[aim.group]);
  if (light.isZero(0.0f)) return;
  batch_->shadowed[static_cast<std::size_t>(batch_->shadow_rays.count())] = {light, static_cast<std::uint16_t>(path),
                                                                             true};
  batch_->shadow_rays.add(point.position, aim.direction, aim.distance,
                          render::alpha_random_number(start.index, start.seed, 1));
}

void LightTracer::from_lamps(std::span<const LightSpot> spots, const TracerSettings& settings,
                             std::span<LampLight> ret) {
  constexpr std::size_t kTogether = render::kMaxRays / kRound;
  std::vector<Estimate> estimates(spots.size());
  std::vector<std::size_t> active;
  for (std::size_t i = 0; i < spots.size(); ++i) {
    if (spots[i].exists()) active.push_back(i);
  }
  for (int done = 0; done < settings.max_light_rays && !active.empty(); done += kRound) {
    for (std::size_t first = 0; first < active.size(); first += kTogether) {
      if (must_end()) return;
      const std::size_t end = std::min(first + kTogether, active.size());
      const std::size_t count = (end - first) * kRound;
      for (std::size_t path = 0; path < count; ++path) {
        begin(spots[active[first + path / kRound]],
              static_cast<std::uint32_t>(done) + static_cast<std::uint32_t>(path % kRound), path);
        Start& start = starts_[path];
        start.u = render::sobol_value(start.index, start.seed, kLampChoice);
        part_[path] = static_cast<std::uint8_t>(start.u * kParts);
      }
      for (const std::uint16_t path : by_part(count)) add_light_ray(path);
      render::trace_shadows(scene_, *batch_);
      for (std::size_t path = 0; path < count; ++path) {
        estimates[active[first + path / kRound]].add(light_of(batch_->path[path]), directions_[path]);
      }
    }
    std::erase_if(active, [&](std::size_t i) {
      estimates[i].end_round();
      if (!(estimates[i].mean() > 0.0)) return done + kRound >= std::max(kMinDarkRays, settings.max_light_rays / 4);
      return estimates[i].error() <= static_cast<double>(settings.light_error) * estimates[i].mean();
    });
  }
  for (std::size_t i = 0; i < spots.size(); ++i) ret[i] = estimates[i].result();
}

void LightTracer::add_scattered_ray(bool only_lamps, float spread, std::size_t path) {
  const Start& start = starts_[path];
  const LightPoint& point = *start.from;
  const Vec3 direction = render::from_frame_of(point.normal, render::cosine_hemisphere({start.u, start.v}));
  if (!(point.facing.dot(direction) > 0.0f)) return;
  render::RayStage& stage = batch_->current();
  render::PathRay& ray = stage.state[static_cast<std::size_t>(stage.rays.count())];
  ray = render::PathRay{};
  directions_[path] = direction;
  ray.pdf = std::max(0.0f, point.normal.dot(direction)) / render::kPi;
  ray.from_normal = point.normal;
  ray.cone_spread = spread;
  ray.path = static_cast<std::uint16_t>(path);
  ray.scatterings = 1;
  ray.surfaces = 1;
  ray.aimed_surfaces = 1;
  ray.only_light = only_lamps;
  stage.rays.add(point.position, direction, std::numeric_limits<float>::infinity(),
                 render::alpha_random_number(start.index, start.seed, 2));
}

void LightTracer::from_surfaces(std::span<const LightSpot> spots, GatherSettings settings,
                                std::span<GatheredLight> ret) {
  CHECK(settings.rays >= 1 && (settings.rays & (settings.rays - 1)) == 0);
  const int round = std::min(settings.rays, render::kMaxRays);
  gather(spots, 0, round, settings.bounces, ret);
  std::vector<std::uint32_t> active(spots.size());
  std::iota(active.begin(), active.end(), 0u);
  for (int done = round; done < settings.rays; done *= 2) {
    std::erase_if(active, [&](std::uint32_t i) {
      return !spots[i].exists() ||
             ret[i].error <= settings.error * (render::luminance(ret[i].light) + settings.dim_light);
    });
    add_rays(spots, active, done, settings.bounces, ret);
  }
}

void LightTracer::add_rays(std::span<const LightSpot> spots, std::span<const std::uint32_t> active, int done,
                           int bounces, std::span<GatheredLight> ret) {
  std::vector<LightSpot> chosen;
  for (const std::uint32_t i : active) chosen.push_back(spots[i]);
  std::vector<GatheredLight> sum(active.size());
  std::vector<GatheredLight> more(active.size());
  const int rounds = done / render::kMaxRays;
  for (int k = 0; k < rounds; ++k) {
    gather(chosen, done + k * render::kMaxRays, render::kMaxRays, bounces, more);
    for (std::size_t i = 0; i < more.size(); ++i) {
      sum[i].light += more[i].light;
      sum[i].direction += more[i].direction;
      sum[i].error = std::hypot(sum[i].error, more[i].error);
    }
  }
  const float share = 0.5f / static_cast<float>(rounds);
  for (std::size_t k = 0; k < active.size(); ++k) {
    GatheredLight& light = ret[active[k]];
    light.light = 0.5f * light.light + share * sum[k].light;
    light.direction = 0.5f * light.direction + share * sum[k].direction;
    light.error = std::hypot(0.5f * light.error, share * sum[k].error);
  }
}

void LightTracer::gather(std::span<const LightSpot> spots, int first_ray, int rays, int bounces,
                         std::span<GatheredLight> ret) {
  const std::size_t together = static_cast<std::size_t>(render::kMaxRays / rays);
  const bool only_lamps = bounces == 0;
  view_.quality.bounces = bounces;
  const auto per_spot = static_cast<std::size_t>(rays);
  // Textures are blurred over the solid angle of a ray.
  const float spread = std::sqrt(2.0f * render::kPi / static_cast<float>(rays));
  for (std::size_t first = 0; first < spots.size(); first += together) {
    if (must_end()) return;
    const std::size_t count = std::min(together, spots.size() - first);
    batch_->stage = 0;
    view_.light = scene_.light;
    for (std::size_t i = 0; i < count * per_spot; ++i) {
      const LightSpot& spot = spots[first + i / per_spot];
      part_[i] = 0;
      if (!spot.exists()) {
        batch_->path[i] = render::Path{};
        continue;
      }
      begin(spot, static_cast<std::uint32_t>(first_ray) + static_cast<std::uint32_t>(i % per_spot), i);
      Start& start = starts_[i];
      batch_->path[i].index_reversed = start.index;
      batch_->path[i].seed = render::mix_bits(start.seed ^ kPathSeed);
      const render::SobolPoint u = render::sobol_point(start.index, start.seed, kDirection);
      start.u = u.u;
      start.v = u.v;
      part_[i] = static_cast<std::uint8_t>(8 * static_cast<int>(u.u * 8.0f) + static_cast<int>(u.v * 8.0f));
    }
    for (const std::uint16_t i : by_part(count * per_spot)) {
      if (spots[first + i / per_spot].exists()) add_scattered_ray(only_lamps, spread, i);
    }
    render::trace_paths(scene_, shade_, view_, render::Coherence::kIncoherent, *batch_, *film_);
    for (std::size_t p = 0; p < count; ++p) {
      Estimate sum;
      for (std::size_t i = p * per_spot; i < (p + 1) * per_spot; ++i) {
        sum.add(light_of(batch_->path[i]), directions_[i]);
        if ((i + 1) % kRound == 0) sum.end_round();
      }
      ret[first + p] = sum.gathered(rays);
    }
  }
}

void LightTracer::find_visible(std::span<const std::array<Vec3, 2>> pairs, std::span<std::uint8_t> ret) {
  for (std::size_t first = 0; first < pairs.size(); first += render::kMaxRays) {
    if (must_end()) return;
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

void LightTracer::find_free_share(std::span<const std::array<Vec3, 2>> pairs, std::span<float> ret) {
  render::RayQueue<RTCRayHit16>& rays = batch_->current().rays;
  for (std::size_t first = 0; first < pairs.size(); first += render::kMaxRays) {
    if (must_end()) return;
    const std::size_t count = std::min<std::size_t>(render::kMaxRays, pairs.size() - first);
    for (std::size_t i = 0; i < count; ++i)
      rays.add(pairs[first + i][0], pairs[first + i][1] - pairs[first + i][0], 1.0f, 0);
    render::trace_nearest(scene_.top, render::Coherence::kIncoherent, rays);
    for (int i = 0; i < static_cast<int>(count); ++i) {
      ret[first + static_cast<std::size_t>(i)] = rays.has_hit(i) ? std::clamp(rays.distance(i), 0.0f, 1.0f) : 1.0f;
    }
    rays.clear();
  }
}

}  // namespace cyclorama::light_baking
