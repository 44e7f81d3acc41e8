// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light_baking/visible_triangles.h"

#include <tbb/parallel_for.h>

#include <atomic>
#include <bit>
#include <memory>
#include <numbers>

#include "common/base/cpu_time.h"
#include "renderfarm/render/ray_queue.h"
#include "renderfarm/render/sampler.h"
#include "renderfarm/render/surface.h"
#include "renderfarm/scene/area.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama::light_baking {
namespace {

using render::Vec3;

/// Maximum height of the sampled eyes above and below the scene's start eye, in metres; allows for children, tall
/// people and bent heads.
constexpr double kHeightBand = 0.25;
/// Maximum attempts to find a walkable position. If the area is too narrow, only the start is used.
constexpr int kMaxAttempts = 10'000;

bool is_walkable(const scene::SceneInfo& info, const Eigen::Vector2d& place) {
  if (!scene::is_inside(info.walkable, place)) return false;
  return std::ranges::none_of(info.walkable_holes, [&](const auto& hole) { return scene::is_inside(hole, place); });
}

/// Encoded observations, with the distance in the upper bits, so that threads can lower them atomically: positive
/// floats have the order of their bits.
using Bits = std::vector<std::atomic<std::uint64_t>>;

std::uint64_t bits_of(const SeenPlace& place) {
  return static_cast<std::uint64_t>(std::bit_cast<std::uint32_t>(place.distance)) << 32 |
         static_cast<std::uint64_t>(place.u) << 16 | place.v;
}

SeenPlace place_of(std::uint64_t bits) {
  return {std::bit_cast<float>(static_cast<std::uint32_t>(bits >> 32)), static_cast<std::uint16_t>(bits >> 16),
          static_cast<std::uint16_t>(bits)};
}

std::uint16_t coded_weight(float weight) {
  return static_cast<std::uint16_t>(std::lround(std::clamp(weight, 0.0f, 1.0f) * 65535.0f));
}

void lower(std::atomic<std::uint64_t>& bits, std::uint64_t value) {
  std::uint64_t known = bits.load(std::memory_order_relaxed);
  while (value < known && !bits.compare_exchange_weak(known, value, std::memory_order_relaxed)) {
  }
}

/// Returns direction number `i` of `count` directions on a regular grid over the sphere, row by row, so that rays of a
/// packet hit neighbouring triangles. `shift` in [0, 1)^2 moves the grid.
Vec3 direction_of(int i, int count, const Eigen::Vector2d& shift) {
  const int columns = static_cast<int>(std::sqrt(2.0 * count));
  const int rows = std::max(1, count / columns);
  const int row = i / columns;
  const double v = (row + shift.y()) / rows;
  const double u = (i % columns + shift.x()) / columns;
  const double height = 1.0 - 2.0 * std::min(v, 1.0);
  const double across = std::sqrt(std::max(0.0, 1.0 - height * height));
  const double angle = 2.0 * std::numbers::pi * u;
  return Eigen::Vector3d(across * std::cos(angle), height, across * std::sin(angle)).cast<float>();
}

}  // namespace

render::Vec3 SeenPlace::weights() const {
  constexpr float kUnit = 1.0f / 65535.0f;
  const float second = static_cast<float>(u) * kUnit;
  const float third = static_cast<float>(v) * kUnit;
  return {std::max(0.0f, 1.0f - second - third), second, third};
}

std::vector<Eigen::Vector3d> walkable_eyes(const scene::SceneInfo& info, int count, std::uint64_t seed) {
  std::vector<Eigen::Vector3d> eyes = {info.start_eye};
  if (info.walkable.size() < 3) return eyes;
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& corner : info.walkable) box.extend(corner);
  const auto random = static_cast<std::uint32_t>(seed);
  for (std::uint32_t i = 0; static_cast<int>(eyes.size()) < count && i < kMaxAttempts; ++i) {
    const std::uint32_t index = render::reversed_bits(i);
    const render::SobolPoint at = render::sobol_point(index, random, 0);
    const float height = render::sobol_value(index, random, 1);
    const Eigen::Vector2d place =
        box.min() + box.sizes().cwiseProduct(Eigen::Vector2d(static_cast<double>(at.u), static_cast<double>(at.v)));
    if (!is_walkable(info, place)) continue;
    eyes.emplace_back(place.x(), info.start_eye.y() + kHeightBand * (2.0 * static_cast<double>(height) - 1.0),
                      place.y());
  }
  return eyes;
}

VisibleTriangles find_visible_triangles(const render::Renderer& renderer, const BakeSettings& settings,
                                        const std::function<bool()>& cancelled) {
  const render::TraceScene& scene = renderer.traced();
  const std::vector<Eigen::Vector3d> eyes = walkable_eyes(renderer.scene().info, settings.eyes, settings.seed);
  std::vector<std::array<Bits, 2>> nearest(scene.placements.size());
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    for (Bits& bits : nearest[i]) {
      bits = Bits(scene.placements[i].mesh->triangle_count);
      for (std::atomic<std::uint64_t>& value : bits) value = bits_of({});
    }
  }
  constexpr int kTogether = render::kMaxRays;
  const int batches = (settings.rays_per_eye + kTogether - 1) / kTogether;
  std::atomic<double> cpu_seconds = 0.0;
  tbb::parallel_for(0, static_cast<int>(eyes.size()) * batches, [&](int job) {
    if (cancelled && cancelled()) return;
    const double before = thread_cpu_seconds();
    const auto eye_number = static_cast<std::size_t>(job / batches);
    const Vec3 eye = (eyes[eye_number] - renderer.origin()).cast<float>();
    const render::SobolPoint shift = render::sobol_point(render::reversed_bits(static_cast<std::uint32_t>(eye_number)),
                                                         static_cast<std::uint32_t>(settings.seed), 2);
    const auto rays = std::make_unique<render::RayQueue<RTCRayHit16>>();
    const int first = job % batches * kTogether;
    for (int i = first; i < std::min(first + kTogether, settings.rays_per_eye); ++i) {
      rays->add(eye,
                direction_of(i, settings.rays_per_eye, {static_cast<double>(shift.u), static_cast<double>(shift.v)}),
                std::numeric_limits<float>::infinity(), render::mix_bits(static_cast<std::uint32_t>(i)));
    }
    render::trace_nearest(scene.top, render::Coherence::kCoherent, *rays);
    for (int i = 0; i < rays->count(); ++i) {
      if (!rays->has_hit(i)) continue;
      const RTCHit hit = rays->hit(i);
      if (hit.instID[0] == RTC_INVALID_GEOMETRY_ID && hit.geomID >= scene.placements.size()) continue;  // A lamp.
      const render::SurfacePoint point = render::surface_at(render::triangle_at(scene, hit), rays->direction(i));
      lower(nearest[render::top_of(hit)][point.front ? 0 : 1][hit.primID],
            bits_of({rays->distance(i), coded_weight(hit.u), coded_weight(hit.v)}));
    }
    cpu_seconds += thread_cpu_seconds() - before;
  });
  VisibleTriangles visible;
  visible.cpu_seconds = cpu_seconds.load();
  visible.places.resize(nearest.size());
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    for (std::size_t side = 0; side < 2; ++side) {
      std::vector<SeenPlace>& places = visible.places[i][side];
      std::uint64_t seen = 0;
      places.reserve(nearest[i][side].size());
      for (const std::atomic<std::uint64_t>& bits : nearest[i][side]) {
        places.push_back(place_of(bits.load()));
        if (places.back().is_seen()) ++seen;
      }
      if (seen == 0) places.clear();
      visible.seen += seen;
    }
  }
  return visible;
}

}  // namespace cyclorama::light_baking
