// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light_baking/bake_light.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "common/base/cpu_time.h"
#include "renderfarm/light/mean_direction.h"
#include "renderfarm/light/scene_key.h"
#include "renderfarm/light_baking/adaptive_grids.h"
#include "renderfarm/light_baking/base_side.h"
#include "renderfarm/light_baking/check_light.h"
#include "renderfarm/light_baking/smoothing.h"
#include "renderfarm/light_baking/vertex_sites.h"
#include "renderfarm/light_baking/visible_triangles.h"
#include "renderfarm/render/flush_denormals.h"
#include "renderfarm/render/sampler.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama::light_baking {
namespace {

using render::Vec3;

/// Number of points, or of triangles with sites, in one task.
constexpr std::size_t kChunk = 256;
constexpr std::size_t kSitesPerChunk = 1024;
/// Ratio of the largest value that can be stored to the brightest direct light; allows for bounces.
constexpr float kHeadroom = 16.0f;
/// Maximum shadow rays of samples that no visitor sees.
constexpr int kUnseenLightRays = 16;
/// Share of the reported progress that ends before the check.
constexpr double kBakingShare = 0.85;
/// Number of visible parts of an edge above which a triangle is large.
constexpr double kLargeParts = 32.0;

BakeSettings with_dim_light(BakeSettings settings, const scene::Scene& scene) {
  constexpr float kDim = 0.1f;  // Below a tenth of white, relative errors are less visible.
  settings.dim_light = kDim / static_cast<float>(scene.exposure);
  return settings;
}

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
    const VisibleTriangles visible = find_visible_triangles(renderer_, settings_, cancelled_);
    cpu_seconds_ += visible.cpu_seconds;
    baked_.seen_triangles = visible.seen;
    sides_ = base_sides(scene_, visible, settings_.seed);
    TRY(end_stage("what visitors see", 0.05));
    place_sites();
    find_all_blocked();
    TRY(end_stage("sites of vertices", 0.07));
    light_from_lamps();
    TRY(end_stage("light of lamps", 0.2));
    gather(settings_.coarse_rays, true, Which::kAll);
    TRY(publish());
    for (int bounce = 1; bounce < bounces_; ++bounce) {
      gather(settings_.coarse_rays, false, Which::kAll);
      TRY(publish());
      TRY(report(0.2 + 0.15 * bounce / bounces_));
    }
    TRY(end_stage("bounces", 0.35));
    gather(settings_.coarse_rays, bounces_ == 0, Which::kUnseen);
    gather(settings_.final_rays, bounces_ == 0, Which::kSeen);
    TRY(end_stage("last bounce", 0.6));
    for (BaseSide& side : sides_) {
      smooth_gathered_light(*scene_.placements[side.placement].mesh, &side);
      sharpen(scene_.placements[side.placement], &side);
    }
    make_all_grids();  // Grids use the same bounce as the base samples, so nothing is published in between.
    for (const SideGrids& fine : fine_) {
      baked_.grids += fine.grids.size();
      for (const MadeGrid& grid : fine.grids) {
        for (const std::uint8_t separate : grid.separate) baked_.separate_samples += separate;
      }
    }
    TRY(publish());
    TRY(end_stage("grids", 1.0));
    baked_.store = published_;
    baked_.cpu_seconds = cpu_seconds_.load();
    return std::move(baked_);
  }

 private:
  enum class Which { kAll, kSeen, kUnseen };

  [[nodiscard]] Status report(double fraction) const {
    if (cancelled_ && cancelled_()) return Error(ErrorCode::kUnavailable, "computing light was cancelled");
    if (progress_) progress_(fraction);
    return Done{};
  }

  [[nodiscard]] Status end_stage(std::string name, double fraction) {
    const double now = cpu_seconds_.load();
    baked_.stages.push_back({std::move(name), now - stage_began_});
    stage_began_ = now;
    return report(fraction);
  }

  [[nodiscard]] LitSide lit(const BaseSide& side) const {
    return {&scene_.placements[side.placement],
            side.back,
            side.per_triangle,
            side.points,
            side.light,
            side.lamp_ranges,
            bounces_ == 0};
  }

  /// Calls work(chunk, first, end, tracer) in parallel.
  template <typename Work>
  void for_chunks(std::size_t count, std::size_t per_chunk, Work work) {
    tbb::parallel_for(std::size_t{0}, (count + per_chunk - 1) / per_chunk, [&](std::size_t chunk) {
      if (cancelled_ && cancelled_()) return;
      const double before = thread_cpu_seconds();
      const render::FlushDenormals flush;
      work(chunk, chunk * per_chunk, std::min((chunk + 1) * per_chunk, count), *tracers_.local());
      cpu_seconds_ += thread_cpu_seconds() - before;
    });
  }

  void place_sites() {
    for (BaseSide& side : sides_) {
      if (side.per_triangle) continue;
      std::vector<VertexSite> sites(3 * side.triangles.size());
      for_chunks(side.triangles.size(), kSitesPerChunk,
                 [&](std::size_t, std::size_t first, std::size_t end, LightTracer& tracer) {
                   const std::span triangles = std::span(std::as_const(side.triangles)).subspan(first, end - first);
                   std::ranges::copy(find_sites(scene_, side, triangles, tracer),
                                     sites.begin() + 3 * static_cast<std::ptrdiff_t>(first));
                 });
      baked_.hidden_vertices += assign_sites(scene_.placements[side.placement], sites, &side);
    }
  }

  void find_all_blocked() {
    for (BaseSide& side : sides_) {
      side.blocked.resize(scene_.placements[side.placement].mesh->triangle_count, 0);
      std::vector<std::uint32_t> wide;
      for (const SeenTriangle& seen : side.triangles) {
        const double parts = visible_parts(scene_.placements[side.placement], seen, settings_);
        if (parts > kLargeParts) side.large.push_back(seen.triangle);
        if (parts >= kMinBlockedParts) wide.push_back(seen.triangle);
      }
      for_chunks(wide.size(), kSitesPerChunk,
                 [&](std::size_t, std::size_t first, std::size_t end, LightTracer& tracer) {
                   const std::span triangles = std::span(std::as_const(wide)).subspan(first, end - first);
                   for (const std::uint32_t triangle : find_blocked(lit(side), triangles, tracer)) {
                     side.blocked[triangle] = 1;
                   }
                 });
    }
  }

  /// Calls work(side, samples, their spots, tracer) for chunks of base samples, in parallel.
  template <typename Work>
  void for_points(Which which, Work work) {
    for (BaseSide& side : sides_) {
      std::vector<std::uint32_t> chosen;
      for (const std::uint32_t i : side.order) {
        const bool is_seen = side.seen[i] != Seen::kNo;
        if (which == Which::kAll || is_seen == (which == Which::kSeen)) chosen.push_back(i);
      }
      for_chunks(chosen.size(), kChunk, [&](std::size_t, std::size_t first, std::size_t end, LightTracer& tracer) {
        const std::span<const std::uint32_t> part = std::span(chosen).subspan(first, end - first);
        std::vector<LightSpot> spots;
        for (const std::uint32_t i : part) spots.push_back(spot_of(scene_.placements[side.placement], side, i));
        work(side, part, spots, tracer);
      });
    }
  }

  void light_from_lamps() {
    for (const Which which : {Which::kSeen, Which::kUnseen}) {
      const int rays = which == Which::kSeen ? settings_.max_light_rays : kUnseenLightRays;
      const TracerSettings settings{rays, static_cast<float>(settings_.light_error)};
      for_points(which, [&](BaseSide& side, std::span<const std::uint32_t> part, std::span<const LightSpot> spots,
                            LightTracer& tracer) {
        std::vector<LampLight> light(spots.size());
        tracer.from_lamps(spots, settings, light);
        for (std::size_t i = 0; i < part.size(); ++i) side.light[part[i]].lamps = light[i];
      });
    }
    for (BaseSide& side : sides_) find_lamp_ranges(*scene_.placements[side.placement].mesh, &side);
  }

  void gather(int rays, bool only_lamps, Which which) {
    for_points(which, [&](BaseSide& side, std::span<const std::uint32_t> part, std::span<const LightSpot> spots,
                          LightTracer& tracer) {
      std::vector<GatheredLight> light(spots.size());
      tracer.from_surfaces(spots, rays, only_lamps, light);
      for (std::size_t i = 0; i < part.size(); ++i) side.light[part[i]].surfaces = light[i];
    });
  }

  /// Returns the number of samples that grids may have within the budget of bytes.
  [[nodiscard]] std::uint64_t grid_samples() const {
    double triangles = 0.0;
    std::uint64_t taken = 0;
    for (const render::Placement& placement : scene_.placements) {
      triangles += static_cast<double>(placement.mesh->triangle_count);
    }
    for (const BaseSide& side : sides_) {
      const bool has_directions = scene_.placements[side.placement].mesh->material->normal != nullptr;
      taken += side.points.size() * (light::kSampleBytes + (has_directions ? sizeof(std::uint32_t) : 0)) +
               side.blocked.size() * sizeof(std::uint32_t);
    }
    const auto bytes =
        std::max(settings_.min_bytes, static_cast<std::uint64_t>(settings_.bytes_per_triangle * triangles));
    return std::min<std::uint64_t>((bytes - std::min(bytes, taken)) / light::kSampleBytes,
                                   light::TriangleGrid::kMaxOffset);
  }

  void make_all_grids() {
    std::vector<SeenSide> seen;
    seen.reserve(sides_.size());
    for (const BaseSide& side : sides_) seen.push_back({lit(side), side.triangles});
    GridBudget budget;
    budget.samples = grid_samples();
    budget.is_over = [this] {
      return (cancelled_ && cancelled_()) ||
             (settings_.max_cpu_seconds > 0.0 && cpu_seconds_.load() > settings_.max_cpu_seconds);
    };
    budget.add_cpu_seconds = [this](double seconds) { cpu_seconds_ += seconds; };
    if (progress_) budget.report_progress = [this](double fraction) { progress_(0.6 + 0.4 * fraction); };
    fine_ = make_grids(seen, settings_, budget, tracers_);
  }

  /// Encodes light. `seed` randomizes the rounding, so that errors of neighbouring samples cancel.
  [[nodiscard]] std::uint32_t encoded(const Vec3& light, std::uint32_t seed) const {
    return light::to_rgb9e5((light + scene_.ambient) / unit_, render::to_unit_float(render::mix_bits(seed)));
  }

  [[nodiscard]] std::uint8_t coded_error(float error) const { return light::to_error_code(error / unit_); }

  /// Chooses the unit from the direct light. Called once.
  void choose_unit() {
    float brightest = scene_.ambient.maxCoeff();
    for (const BaseSide& side : sides_) {
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
    for (std::size_t s = 0; s < sides_.size(); ++s) {
      const BaseSide& side = sides_[s];
      light::SurfaceLight& surface = store->surfaces[side.placement];
      surface.base_per_triangle = side.per_triangle;
      light::SideLight& out = surface.sides[side.back ? 1 : 0];
      out.base.reserve(side.points.size());
      out.base_errors.reserve(side.points.size());
      for (std::size_t i = 0; i < side.points.size(); ++i) {
        const PointLight& light = side.light[i];
        out.base.push_back(side.points[i].exists()
                               ? encoded(light.lamps.light + light.surfaces.light, side.points[i].seed)
                               : light::kNoSample);
        out.base_errors.push_back(coded_error(std::hypot(light.lamps.error, light.surfaces.error)));
      }
      if (scene_.placements[side.placement].mesh->material->normal != nullptr) add_directions(side, &out);
      if (fine_.empty()) {
        add_grids(side, {{}, side.large}, &out);
      } else {
        add_grids(side, fine_[s], &out);
      }
    }
    published_ = std::move(store);
    return renderer_.set_light(published_, "the light just computed");
  }

  void add_directions(const BaseSide& side, light::SideLight* out) const {
    out->directions.reserve(side.light.size());
    for (const PointLight& light : side.light) {
      // Ambient light comes evenly from all directions, so its mean direction is zero.
      const float all = render::luminance(light.lamps.light + light.surfaces.light + scene_.ambient);
      const Vec3 sum = light.lamps.direction + light.surfaces.direction;
      out->directions.push_back(all > 0.0f ? light::to_direction_code(sum / all) : 0);
    }
  }

  void add_grids(const BaseSide& side, const SideGrids& fine, light::SideLight* out) const {
    if (fine.grids.empty() && fine.unresolved.empty() && std::ranges::count(side.blocked, 1) == 0) return;
    out->grids.reserve(side.blocked.size());
    for (const std::uint8_t blocked : side.blocked) {
      out->grids.push_back(blocked != 0 ? light::TriangleGrid::kTraced : light::TriangleGrid::kBase);
    }
    for (const std::uint32_t triangle : fine.unresolved) out->grids[triangle] = light::TriangleGrid::kTraced;
    for (const MadeGrid& grid : fine.grids) {
      out->grids[grid.triangle] =
          light::TriangleGrid::code(grid.parts, static_cast<std::uint32_t>(out->samples.size()));
      for (std::size_t i = 0; i < grid.light.size(); ++i) {
        out->samples.push_back(grid.separate[i] != 0 ? light::kNoSample
                                                     : encoded(grid.light[i].light, grid.triangle * 0x9e3779b9u +
                                                                                        static_cast<std::uint32_t>(i)));
        out->sample_errors.push_back(coded_error(grid.light[i].error));
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
  BakedLight baked_;
  std::vector<BaseSide> sides_;
  std::vector<SideGrids> fine_;  ///< One for each side; empty until the grids are made.
  float unit_ = 1.0f;
  std::shared_ptr<const light::LightStore> published_;
  std::atomic<double> cpu_seconds_ = 0.0;
  double stage_began_ = 0.0;
};

/// Adds the measured errors of the light to the store.
Status add_check(render::Renderer& renderer, int eyes, const std::function<void(double)>& progress,
                 const std::function<bool()>& cancelled, BakedLight* baked) {
  CheckSettings settings;
  settings.eyes = eyes;
  TRY_ASSIGN(const CheckedLight checked, check_light(renderer, settings, progress, cancelled));
  const auto store = std::make_shared<light::LightStore>(*baked->store);
  store->check = checked.check;
  baked->store = store;
  baked->check_cpu_seconds = checked.cpu_seconds;
  return renderer.set_light(store, "the light just computed");
}

}  // namespace

Result<BakedLight> bake_light(render::Renderer& renderer, const BakeSettings& settings, int threads,
                              const std::function<void(double)>& progress, const std::function<bool()>& cancelled) {
  if (!renderer.scene().eye_lamp.isZero(0.0f)) {
    return Error(ErrorCode::kInvalidArgument,
                 "this scene is lit by a lamp that the visitor carries, so its light cannot be computed ahead; remove "
                 "the lamp from scene.toml or place lamps");
  }
  TRY(renderer.set_light(nullptr, ""));
  const double baking_share = settings.check_eyes > 0 ? kBakingShare : 1.0;
  const auto share_of_progress = [&](double fraction) {
    if (progress) progress(baking_share * fraction);
  };
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  Result<BakedLight> baked =
      arena.execute([&] { return Baker(renderer, settings, share_of_progress, cancelled).run(); });
  if (baked && settings.check_eyes > 0) {
    const Status checked = add_check(
        renderer, settings.check_eyes,
        [&](double fraction) {
          if (progress) progress(baking_share + (1.0 - baking_share) * fraction);
        },
        cancelled, &*baked);
    if (!checked) baked = checked.error();
  }
  if (!baked) TRY(renderer.set_light(nullptr, ""));
  return baked;
}

}  // namespace cyclorama::light_baking
