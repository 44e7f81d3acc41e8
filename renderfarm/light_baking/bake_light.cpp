// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light_baking/bake_light.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>

#include "common/base/cpu_time.h"
#include "renderfarm/light/mean_direction.h"
#include "renderfarm/light/scene_key.h"
#include "renderfarm/light_baking/adaptive_grids.h"
#include "renderfarm/light_baking/visible_triangles.h"
#include "renderfarm/render/flush_denormals.h"
#include "renderfarm/render/sampler.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama::light_baking {
namespace {

using render::Vec3;

/// Number of points in one task.
constexpr std::size_t kChunk = 256;
/// Headroom of the unit above the brightest direct light, for bounces.
constexpr float kHeadroom = 16.0f;
/// Steps from a seen triangle to its neighbours for which light is computed finely, too: visitors see more than the
/// sampled eyes.
constexpr int kRings = 2;
/// A triangle is large if this many visible parts lie along its edge.
constexpr double kLargeParts = 32.0;

BakeSettings with_dim_light(BakeSettings settings, const scene::Scene& scene) {
  constexpr float kDim = 0.1f;  // A tenth of white: where light is dimmer, relative errors are less visible.
  settings.dim_light = kDim / static_cast<float>(scene.exposure);
  return settings;
}

/// The base samples of one side of a placement, while they are computed.
struct Side {
  std::size_t placement = 0;
  bool back = false;
  bool per_triangle = false;
  std::vector<LightPoint> points;
  std::vector<PointLight> light;
  std::vector<std::uint8_t> seen;
  std::vector<SeenTriangle> triangles;
  std::vector<std::uint8_t> blocked;  ///< 1 for triangles between whose corners light must not be interpolated.
  /// Triangles so large that the light between their corners cannot be derived from them: bounces trace paths there.
  std::vector<std::uint32_t> large;
  SideGrids fine;
};

class Baker {
 public:
  Baker(render::Renderer& renderer, const BakeSettings& settings, const std::function<void(double)>& progress,
        const std::function<bool()>& cancelled)
      : renderer_(renderer),
        scene_(renderer.traced()),
        settings_(with_dim_light(settings, renderer.scene())),
        progress_(progress),
        cancelled_(cancelled),
        bounces_(renderer.scene().bounces),
        tracers_([this] {
          return std::make_unique<LightTracer>(scene_, render::shade_stage_for(renderer_.surface_level()), bounces_);
        }) {}

  Result<BakedLight> run() {
    key_ = light::key_of(renderer_.scene());
    BakedLight baked;
    const VisibleTriangles visible = find_visible_triangles(renderer_, settings_, cancelled_);
    baked.seen_triangles = visible.seen;
    place_samples(visible);
    find_all_blocked();
    TRY(report(0.05));
    light_from_lamps(false);
    TRY(report(0.1));
    gather(settings_.coarse_rays, true, false);
    TRY(publish());
    for (int bounce = 1; bounce < bounces_; ++bounce) {
      gather(settings_.coarse_rays, false, false);
      TRY(publish());
      TRY(report(0.1 + 0.15 * bounce / bounces_));
    }
    light_from_lamps(true);
    TRY(report(0.3));
    gather(settings_.coarse_rays, bounces_ == 0, false);
    gather(settings_.final_rays, bounces_ == 0, true);
    TRY(report(0.7));
    has_grids_ = true;
    make_all_grids();  // They read the same bounce as the base samples, so nothing needs to be published in between.
    for (const Side& side : sides_) {
      baked.grids += side.fine.grids.size();
      for (const MadeGrid& grid : side.fine.grids) {
        for (const std::uint8_t separate : grid.separate) baked.separate_samples += separate;
      }
    }
    TRY(publish());
    TRY(report(1.0));
    baked.store = published_;
    baked.cpu_seconds = cpu_seconds_.load();
    return baked;
  }

 private:
  [[nodiscard]] Status report(double fraction) const {
    if (cancelled_ && cancelled_()) return Error(ErrorCode::kUnavailable, "computing light was cancelled");
    if (progress_) progress_(fraction);
    return Done{};
  }

  void place_samples(const VisibleTriangles& visible) {
    for (std::size_t i = 0; i < scene_.placements.size(); ++i) {
      const auto seed = render::mix_bits(static_cast<std::uint32_t>(settings_.seed) +
                                         0x9e3779b9u * static_cast<std::uint32_t>(i + 1));
      const std::array<std::vector<float>, 2>& distance = visible.distance[i];
      for (const bool back : {false, true}) {
        // Rays between surfaces need the front only, unless visitors see nothing but the back.
        const bool wanted = back ? !distance[1].empty() : (!distance[0].empty() || distance[1].empty());
        if (!wanted) continue;
        Side side;
        side.placement = i;
        side.back = back;
        side.per_triangle = scene_.placements[i].mesh->normals == nullptr;
        side.points = base_points(scene_.placements[i], seed);
        if (back) {
          for (LightPoint& point : side.points) point = other_side(point);
        }
        side.light.resize(side.points.size());
        mark_seen(distance[back ? 1 : 0], &side);
        sides_.push_back(std::move(side));
      }
    }
  }

  void mark_seen(const std::vector<float>& distance, Side* side) const {
    const render::SurfaceMesh& mesh = *scene_.placements[side->placement].mesh;
    side->seen.assign(side->points.size(), 0);
    for (std::size_t t = 0; t < distance.size(); ++t) {
      if (!(distance[t] < kUnseen)) continue;
      side->triangles.push_back({static_cast<std::uint32_t>(t), distance[t]});
      if (side->per_triangle) {
        side->seen[t] = 1;
      } else {
        for (const std::uint32_t vertex : mesh.triangles[t]) side->seen[vertex] = 1;
      }
    }
    if (side->per_triangle) return;
    for (int ring = 0; ring < kRings; ++ring) {
      const std::vector<std::uint8_t> before = side->seen;
      for (std::size_t t = 0; t < mesh.triangle_count; ++t) {
        const std::array<std::uint32_t, 3>& corners = mesh.triangles[t];
        if (before[corners[0]] + before[corners[1]] + before[corners[2]] == 0) continue;
        for (const std::uint32_t vertex : corners) side->seen[vertex] = 1;
      }
    }
  }

  [[nodiscard]] LitSide lit(const Side& side) const {
    return {&scene_.placements[side.placement], side.back, side.per_triangle, side.points, side.light, bounces_ == 0};
  }

  void find_all_blocked() {
    for (Side& side : sides_) {
      side.blocked.resize(scene_.placements[side.placement].mesh->triangle_count);
      const std::size_t chunks = (side.blocked.size() + kChunk - 1) / kChunk;
      std::vector<std::uint8_t> is_wide(side.blocked.size(), 0);
      for (const SeenTriangle& seen : side.triangles) {
        const double parts = visible_parts(scene_.placements[side.placement], seen, settings_);
        if (parts > kLargeParts) side.large.push_back(seen.triangle);
        if (parts >= kMinBlockedParts) is_wide[seen.triangle] = 1;
      }
      tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t chunk) {
        if (cancelled_ && cancelled_()) return;
        const double before = thread_cpu_seconds();
        const std::size_t first = chunk * kChunk;
        const std::size_t count = std::min(kChunk, side.blocked.size() - first);
        find_blocked(lit(side), static_cast<std::uint32_t>(first), *tracers_.local(),
                     std::span(side.blocked).subspan(first, count));
        for (std::size_t i = first; i < first + count; ++i) {
          if (is_wide[i] == 0) side.blocked[i] = 0;
        }
        cpu_seconds_ += thread_cpu_seconds() - before;
      });
    }
  }

  /// Calls work(side, points, first index) for chunks of all base samples that are seen, or of all.
  template <typename Work>
  void for_points(bool only_seen, Work work) {
    for (Side& side : sides_) {
      std::vector<std::uint32_t> chosen;
      for (std::size_t i = 0; i < side.points.size(); ++i) {
        if (side.points[i].exists() && (!only_seen || side.seen[i] != 0))
          chosen.push_back(static_cast<std::uint32_t>(i));
      }
      const std::size_t chunks = (chosen.size() + kChunk - 1) / kChunk;
      tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t chunk) {
        if (cancelled_ && cancelled_()) return;
        const double before = thread_cpu_seconds();
        const render::FlushDenormals flush;
        const std::size_t first = chunk * kChunk;
        const std::span<const std::uint32_t> part =
            std::span(chosen).subspan(first, std::min(kChunk, chosen.size() - first));
        std::vector<LightPoint> points;
        for (const std::uint32_t i : part) points.push_back(side.points[i]);
        work(side, part, points, *tracers_.local());
        cpu_seconds_ += thread_cpu_seconds() - before;
      });
    }
  }

  void light_from_lamps(bool final) {
    const TracerSettings settings{final ? settings_.max_light_rays : std::min(16, settings_.max_light_rays),
                                  static_cast<float>(settings_.light_error)};
    for_points(final, [&](Side& side, std::span<const std::uint32_t> part, std::span<const LightPoint> points,
                          LightTracer& tracer) {
      std::vector<LampLight> light(points.size());
      tracer.from_lamps(points, settings, light);
      for (std::size_t i = 0; i < part.size(); ++i) side.light[part[i]].lamps = light[i];
    });
  }

  void gather(int rays, bool only_lamps, bool only_seen) {
    for_points(only_seen, [&](Side& side, std::span<const std::uint32_t> part, std::span<const LightPoint> points,
                              LightTracer& tracer) {
      std::vector<GatheredLight> light(points.size());
      tracer.from_surfaces(points, rays, only_lamps, light);
      for (std::size_t i = 0; i < part.size(); ++i) side.light[part[i]].surfaces = light[i];
    });
  }

  /// Returns the samples that grids may take within the budget of bytes.
  [[nodiscard]] std::uint64_t grid_samples() const {
    double triangles = 0.0;
    std::uint64_t taken = 0;
    for (const render::Placement& placement : scene_.placements) {
      triangles += static_cast<double>(placement.mesh->triangle_count);
    }
    for (const Side& side : sides_) {
      const bool has_directions = scene_.placements[side.placement].mesh->material->normal != nullptr;
      taken += side.points.size() * (has_directions ? 2 : 1) + side.blocked.size();
    }
    const auto bytes =
        std::max(settings_.min_bytes, static_cast<std::uint64_t>(settings_.bytes_per_triangle * triangles));
    const std::uint64_t samples = bytes / sizeof(std::uint32_t);
    return std::min<std::uint64_t>(samples - std::min(samples, taken), light::TriangleGrid::kMaxOffset);
  }

  void make_all_grids() {
    std::vector<SeenSide> seen;
    seen.reserve(sides_.size());
    for (const Side& side : sides_) seen.push_back({lit(side), side.triangles});
    GridBudget budget;
    budget.samples = grid_samples();
    budget.is_over = [this] {
      return (cancelled_ && cancelled_()) ||
             (settings_.max_cpu_seconds > 0.0 && cpu_seconds_.load() > settings_.max_cpu_seconds);
    };
    budget.add_cpu_seconds = [this](double seconds) { cpu_seconds_ += seconds; };
    if (progress_) budget.report_progress = [this](double fraction) { progress_(0.7 + 0.3 * fraction); };
    std::vector<SideGrids> made = make_grids(seen, settings_, budget, tracers_);
    for (std::size_t i = 0; i < made.size(); ++i) sides_[i].fine = std::move(made[i]);
  }

  /// `seed` determines the rounding, so that errors of neighbouring samples cancel.
  [[nodiscard]] std::uint32_t encoded(const Vec3& light, std::uint32_t seed) const {
    return light::to_rgb9e5((light + scene_.ambient) / unit_, render::to_unit_float(render::mix_bits(seed)));
  }

  /// Chooses the unit from the direct light, once.
  void choose_unit() {
    float brightest = scene_.ambient.maxCoeff();
    for (const Side& side : sides_) {
      for (const PointLight& light : side.light) {
        brightest = std::max(brightest, (light.lamps.light + light.surfaces.light).maxCoeff());
      }
    }
    if (brightest > 0.0f && std::isfinite(brightest)) unit_ = kHeadroom * brightest / light::kMaxRgb9e5;
  }

  /// Makes the light computed so far available to rays.
  Status publish() {
    if (published_ == nullptr) choose_unit();
    auto store = std::make_shared<light::LightStore>();
    store->scene = key_;
    store->unit = unit_;
    store->settings = fmt::format(
        "{} eyes, {} pixels per degree, {} pixels per sample, {} + {} rays, probe error {}, {} bytes per triangle, "
        "seed {}",
        settings_.eyes, settings_.pixels_per_degree, settings_.pixels_per_sample, settings_.max_light_rays,
        settings_.final_rays, settings_.probe_error, settings_.bytes_per_triangle, settings_.seed);
    store->surfaces.resize(scene_.placements.size());
    for (const Side& side : sides_) {
      light::SurfaceLight& surface = store->surfaces[side.placement];
      surface.base_per_triangle = side.per_triangle;
      light::SideLight& out = surface.sides[side.back ? 1 : 0];
      out.base.reserve(side.points.size());
      for (std::size_t i = 0; i < side.points.size(); ++i) {
        const PointLight& light = side.light[i];
        out.base.push_back(side.points[i].exists()
                               ? encoded(light.lamps.light + light.surfaces.light, side.points[i].seed)
                               : light::kNoSample);
      }
      if (scene_.placements[side.placement].mesh->material->normal != nullptr) add_directions(side, &out);
      add_grids(side, &out);
    }
    published_ = std::move(store);
    return renderer_.set_light(published_, "the light just computed");
  }

  void add_directions(const Side& side, light::SideLight* out) const {
    out->directions.reserve(side.light.size());
    for (const PointLight& light : side.light) {
      // Ambient light comes from all directions, so its mean direction is zero.
      const float all = render::luminance(light.lamps.light + light.surfaces.light + scene_.ambient);
      const Vec3 sum = light.lamps.direction + light.surfaces.direction;
      out->directions.push_back(all > 0.0f ? light::to_direction_code(sum / all) : 0);
    }
  }

  void add_grids(const Side& side, light::SideLight* out) const {
    const std::vector<std::uint32_t>& large = has_grids_ ? side.fine.unresolved : side.large;
    if (side.fine.grids.empty() && large.empty() && std::ranges::count(side.blocked, 1) == 0) return;
    out->grids.reserve(side.blocked.size());
    for (const std::uint8_t blocked : side.blocked) {
      out->grids.push_back(blocked != 0 ? light::TriangleGrid::kTraced : light::TriangleGrid::kBase);
    }
    for (const std::uint32_t triangle : large) out->grids[triangle] = light::TriangleGrid::kTraced;
    for (const MadeGrid& grid : side.fine.grids) {
      out->grids[grid.triangle] =
          light::TriangleGrid::code(grid.parts, static_cast<std::uint32_t>(out->samples.size()));
      for (std::size_t i = 0; i < grid.light.size(); ++i) {
        out->samples.push_back(grid.separate[i] != 0 ? light::kNoSample
                                                     : encoded(grid.light[i], grid.triangle * 0x9e3779b9u +
                                                                                  static_cast<std::uint32_t>(i)));
      }
    }
  }

  render::Renderer& renderer_;
  const render::TraceScene& scene_;
  const BakeSettings settings_;
  const std::function<void(double)>& progress_;
  const std::function<bool()>& cancelled_;
  const int bounces_;
  LightTracers tracers_;
  light::SceneKey key_;
  std::vector<Side> sides_;
  float unit_ = 1.0f;
  bool has_grids_ = false;
  std::shared_ptr<const light::LightStore> published_;
  std::atomic<double> cpu_seconds_ = 0.0;
};

}  // namespace

Result<BakedLight> bake_light(render::Renderer& renderer, const BakeSettings& settings, int threads,
                              const std::function<void(double)>& progress, const std::function<bool()>& cancelled) {
  if (!renderer.scene().eye_lamp.isZero(0.0f)) {
    return Error(ErrorCode::kInvalidArgument,
                 "this scene is lit by a lamp that the visitor carries, so its light cannot be computed ahead; remove "
                 "the lamp from scene.toml or place lamps");
  }
  TRY(renderer.set_light(nullptr, ""));
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  Result<BakedLight> baked = arena.execute([&] { return Baker(renderer, settings, progress, cancelled).run(); });
  if (!baked) TRY(renderer.set_light(nullptr, ""));
  return baked;
}

}  // namespace cyclorama::light_baking
