// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light_baking/bake_group.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "common/base/cpu_time.h"
#include "renderfarm/light/mean_direction.h"
#include "renderfarm/light/scene_key.h"
#include "renderfarm/light_baking/adaptive_grids.h"
#include "renderfarm/light_baking/base_side.h"
#include "renderfarm/light_baking/program_id.h"
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
/// Chunks of points in a piece: a second of work, so that little is lost with it, and some 400 KB of results.
constexpr std::size_t kPointChunksPerPiece = 64;
/// Headroom of the unit above the brightest direct light, for bounces.
constexpr float kHeadroom = 16.0f;
/// Maximum shadow rays of samples that no visitor sees.
constexpr int kUnseenLightRays = 16;
/// Share of BakeSettings::min_rays for each bounce before the last.
constexpr int kBounceDivisor = 4;
/// Number of visible parts of an edge above which a triangle is large.
constexpr double kLargeParts = 32.0;

/// Points, distributed over all surfaces by area, at which the light of lamps is compared with that of the vertices.
constexpr double kAreaProbes = 100'000.0;
/// Triangles with fewer of these points are so small that their errors cancel.
constexpr double kMinAreaProbes = 4.0;
constexpr double kMaxAreaProbes = 256.0;
constexpr std::size_t kProbedPerChunk = 8;

BakeSettings with_dim_light(BakeSettings settings, const scene::Scene& scene) {
  constexpr float kDim = 0.1f;  // Below a tenth of white, relative errors are less visible.
  settings.dim_light = kDim / static_cast<float>(scene.exposure);
  return settings;
}

class Baker {
 public:
  /// Computes the light of one group of lamps. Borrows all but the settings.
  Baker(render::Renderer& renderer, const BakeSettings& settings, std::size_t group,
        const std::function<void(double)>& progress, const std::function<bool()>& cancelled, StageChain& stages)
      : renderer_(renderer),
        scene_(renderer.traced()),
        settings_(with_dim_light(settings, renderer.scene())),
        group_(group),
        ambient_(group == 0 ? Vec3(scene_.ambient) : Vec3(Vec3::Zero())),
        progress_(progress),
        cancelled_(cancelled),
        stages_(stages),
        bounces_(renderer.scene().bounces),
        tracers_([this] {
          return std::make_unique<LightTracer>(scene_, render::shade_stage_for(renderer_.surface_level()), cancelled_,
                                               scene::only_group(group_));
        }) {}

  Result<BakedLight> run() {
    key_ = light::key_of(renderer_.scene());
    add_key();
    TRY(stages_.begin());
    const VisibleTriangles visible = find_visible_triangles(renderer_, settings_, cancelled_);
    cpu_seconds_ += visible.cpu_seconds;
    baked_.seen_triangles = visible.seen;
    sides_ = base_sides(scene_, visible, settings_.seed);
    TRY(end_stage("what visitors see", 0.05));
    if (!shines()) return dark();
    place_sites();
    find_all_blocked();
    TRY(end_stage("sites of vertices", 0.07));
    TRY(light_from_lamps());
    find_all_misread();
    TRY(end_stage("light of lamps", 0.2));
    const int coarse_rays = settings_.rays_of(settings_.coarse_rays, count_of(Which::kAll), kBounceDivisor);
    TRY(gather(coarse_rays, 0, Which::kAll));
    TRY(publish());
    for (int bounce = 1; bounce < bounces_; ++bounce) {
      TRY(gather(coarse_rays, bounce, Which::kAll));
      TRY(publish());
      TRY(report(0.2 + 0.15 * bounce / bounces_));
    }
    TRY(end_stage("bounces", 0.35));
    TRY(gather(settings_.coarse_rays, bounces_, Which::kUnseen));
    TRY(gather(settings_.rays_of(settings_.final_rays, count_of(Which::kSeen), 1), bounces_, Which::kSeen));
    TRY(end_stage("last bounce", 0.6));
    for (BaseSide& side : sides_) {
      smooth_gathered_light(*scene_.placements[side.placement].mesh, &side);
      sharpen(scene_.placements[side.placement], &side);
    }
    TRY(make_all_grids());  // They read the same bounce as the base samples, so nothing is published in between.
    add_misread();
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
    for (const std::unique_ptr<LightTracer>& tracer : tracers_)
      baked_.max_run_seconds = std::max(baked_.max_run_seconds, tracer->max_run());
    return std::move(baked_);
  }

 private:
  enum class Which { kAll, kSeen, kUnseen };

  /// Returns the light of a group that has none: 0 on each side that visitors see.
  [[nodiscard]] BakedLight dark() {
    const std::shared_ptr<light::LightStore> store = new_store();
    for (const BaseSide& side : sides_) {
      light::SurfaceLight& surface = store->surfaces[side.placement];
      surface.base_per_triangle = side.per_triangle;
      light::SideLight& out = surface.sides[side.back ? 1 : 0];
      out.base.assign(side.points.size(), light::to_rgb9e5(Vec3::Zero(), 0.0f));
      out.base_errors.assign(side.points.size(), coded_error(0.0f));
    }
    baked_.store = store;
    baked_.cpu_seconds = cpu_seconds_.load();
    return std::move(baked_);
  }

  [[nodiscard]] Status report(double fraction) const {
    TRY(check_cancelled());
    if (progress_) progress_(fraction);
    return Done{};
  }

  [[nodiscard]] Status check_cancelled() const {
    if (cancelled_ && cancelled_()) return Error(ErrorCode::kUnavailable, "computing light was cancelled");
    return Done{};
  }

  /// Adds to the stages' key what all results depend on.
  void add_key() {
    PieceWriter out;
    out.add(key_.low);
    out.add(key_.high);
    // The structured binding does not compile if a setting is added, so that none is forgotten.
    const auto& [eyes, rays_per_eye, pixels_per_degree, pixels_per_sample, max_light_rays, light_error,
                 max_grid_light_rays, grid_light_error, coarse_rays, final_rays, min_rays, surface_error, probe_error,
                 dim_light, max_parts, bytes_per_triangle, min_bytes, resolving_bytes, max_cpu_seconds, seed,
                 check_eyes] = settings_;
    for (const int value : {eyes, rays_per_eye, max_light_rays, max_grid_light_rays, coarse_rays, final_rays, max_parts,
                            check_eyes, bounces_})
      out.add(value);
    for (const double value : {pixels_per_degree, pixels_per_sample, light_error, grid_light_error, surface_error,
                               probe_error, static_cast<double>(dim_light), bytes_per_triangle, max_cpu_seconds})
      out.add(value);
    out.add(static_cast<std::uint64_t>(group_));
    out.add(min_rays);
    out.add(min_bytes);
    out.add(resolving_bytes);
    out.add(seed);
    stages_.add(out.take());
    stages_.add(program_id());
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
            side.misread,
            bounces_};
  }

  /// Calls work(chunk, first, end, tracer) in parallel.
  template <typename Work>
  void for_chunks(std::size_t count, std::size_t per_chunk, Work work) {
    tbb::parallel_for(std::size_t{0}, (count + per_chunk - 1) / per_chunk, [&](std::size_t chunk) {
      if (cancelled_ && cancelled_()) return;
      const double before = thread_cpu_seconds();
      const render::FlushDenormals flush;
      LightTracer& tracer = *tracers_.local();
      tracer.begin_run();
      work(chunk, chunk * per_chunk, std::min((chunk + 1) * per_chunk, count), tracer);
      tracer.must_end();
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

  [[nodiscard]] static double area_of(const render::Placement& placement, std::uint32_t triangle) {
    const std::array<Vec3, 3> c = corners_of(placement, triangle);
    return 0.5 * static_cast<double>((c[1] - c[0]).cross(c[2] - c[0]).norm());
  }

  void find_all_misread() {
    double all = 0.0;
    for (const BaseSide& side : sides_) {
      const render::Placement& placement = scene_.placements[side.placement];
      for (std::uint32_t t = 0; t < placement.mesh->triangle_count; ++t) all += area_of(placement, t);
    }
    for (BaseSide& side : sides_) {
      const render::Placement& placement = scene_.placements[side.placement];
      std::vector<ProbedTriangle> probed;
      for (std::uint32_t t = 0; t < placement.mesh->triangle_count; ++t) {
        const double probes = kAreaProbes * area_of(placement, t) / all;
        if (probes >= kMinAreaProbes) probed.push_back({t, static_cast<int>(std::min(probes, kMaxAreaProbes))});
      }
      std::vector<std::vector<std::uint32_t>> found((probed.size() + kProbedPerChunk - 1) / kProbedPerChunk);
      for_chunks(probed.size(), kProbedPerChunk,
                 [&](std::size_t chunk, std::size_t first, std::size_t end, LightTracer& tracer) {
                   const std::span triangles = std::span(std::as_const(probed)).subspan(first, end - first);
                   found[chunk] = find_misread(lit(side), triangles, settings_, tracer);
                 });
      side.misread.resize(placement.mesh->triangle_count, 0);
      for (const std::vector<std::uint32_t>& part : found) {
        for (const std::uint32_t triangle : part) side.misread[triangle] = 1;
        side.large.insert(side.large.end(), part.begin(), part.end());
      }
      stages_.add(std::as_bytes(std::span(side.misread)));
    }
  }

  [[nodiscard]] static bool is_among(const BaseSide& side, std::uint32_t sample, Which which) {
    return which == Which::kAll || (side.seen[sample] != Seen::kNo) == (which == Which::kSeen);
  }

  [[nodiscard]] std::uint64_t count_of(Which which) const {
    std::uint64_t count = 0;
    for (const BaseSide& side : sides_) {
      count += static_cast<std::uint64_t>(
          std::ranges::count_if(side.order, [&](std::uint32_t i) { return is_among(side, i, which); }));
    }
    return count;
  }

  /// Base samples of one side that are computed together.
  struct Chunk {
    BaseSide* side = nullptr;
    std::vector<std::uint32_t> samples;
  };

  [[nodiscard]] std::vector<Chunk> chunks_of(Which which) {
    std::vector<Chunk> chunks;
    for (BaseSide& side : sides_) {
      std::vector<std::uint32_t> chosen;
      for (const std::uint32_t i : side.order) {
        if (is_among(side, i, which)) chosen.push_back(i);
      }
      for (std::size_t first = 0; first < chosen.size(); first += kChunk) {
        const std::span part = std::span(chosen).subspan(first, std::min(kChunk, chosen.size() - first));
        chunks.push_back({&side, {part.begin(), part.end()}});
      }
    }
    return chunks;
  }

  /// Only these have a use for the mean direction of their light.
  [[nodiscard]] bool has_directions(const BaseSide& side) const {
    return scene_.placements[side.placement].mesh->material->normal != nullptr;
  }

  /// Completes a stage that sets a part of the light of base samples to what trace(spots, tracer, results) estimates.
  template <typename Light, typename Trace>
  [[nodiscard]] Status trace_stage(Which which, Light PointLight::*part, Trace trace) {
    const std::vector<Chunk> chunks = chunks_of(which);
    const PieceCut cut(chunks.size(), kPointChunksPerPiece);
    StageWork work;
    work.compute = [&](std::uint32_t piece) -> Result<PieceBytes> {
      const std::span part_chunks = std::span(chunks).subspan(cut.first(piece), cut.end(piece) - cut.first(piece));
      std::vector<std::vector<Light>> light(part_chunks.size());
      for_chunks(part_chunks.size(), 1, [&](std::size_t i, std::size_t, std::size_t, LightTracer& tracer) {
        const BaseSide& side = *part_chunks[i].side;
        std::vector<LightSpot> spots;
        for (const std::uint32_t sample : part_chunks[i].samples)
          spots.push_back(spot_of(scene_.placements[side.placement], side, sample));
        light[i].resize(spots.size());
        trace(spots, tracer, light[i]);
      });
      TRY(check_cancelled());
      PieceWriter out;
      for (std::size_t i = 0; i < part_chunks.size(); ++i) {
        const bool directed = has_directions(*part_chunks[i].side);
        for (const Light& sample : light[i]) {
          out.add(sample.light);
          if (directed) out.add(sample.direction);
          out.add(sample.error);
        }
      }
      return out.take();
    };
    work.take = [&](std::uint32_t piece, std::span<const std::byte> bytes) -> Status {
      PieceReader in(bytes);
      for (std::size_t i = cut.first(piece); i < cut.end(piece); ++i) {
        const bool directed = has_directions(*chunks[i].side);
        for (const std::uint32_t sample : chunks[i].samples) {
          Light& light = chunks[i].side->light[sample].*part;
          light.light = in.read_vector();
          if (directed) light.direction = in.read_vector();
          light.error = in.read<float>();
        }
      }
      return in.finished();
    };
    return stages_.complete(cut.pieces(), std::move(work));
  }

  /// Returns false if the group has no light at all, as everything without a group where each lamp has one.
  [[nodiscard]] bool shines() const {
    const render::LightSet& lights = scene_.lights;
    const auto is_in = [&](const auto& light) { return light.group == group_; };
    if (std::ranges::any_of(lights.lamps(), is_in) || std::ranges::any_of(lights.flats(), is_in) ||
        std::ranges::any_of(lights.suns(), is_in))
      return true;
    return group_ == 0 && (lights.triangles() > 0 || lights.has_environment() || !ambient_.isZero(0.0f));
  }

  [[nodiscard]] Status light_from_lamps() {
    for (const Which which : {Which::kSeen, Which::kUnseen}) {
      const int rays =
          settings_.rays_of(which == Which::kSeen ? settings_.max_light_rays : kUnseenLightRays, count_of(which), 1);
      const TracerSettings settings{rays, static_cast<float>(settings_.light_error)};
      TRY(trace_stage(which, &PointLight::lamps,
                      [&](std::span<const LightSpot> spots, LightTracer& tracer, std::span<LampLight> ret) {
                        tracer.from_lamps(spots, settings, ret);
                      }));
    }
    for (BaseSide& side : sides_) find_lamp_ranges(*scene_.placements[side.placement].mesh, &side);
    return Done{};
  }

  [[nodiscard]] Status gather(int rays, int bounces, Which which) {
    return trace_stage(which, &PointLight::surfaces,
                       [&](std::span<const LightSpot> spots, LightTracer& tracer, std::span<GatheredLight> ret) {
                         tracer.from_surfaces(spots, settings_.gathering(rays, bounces), ret);
                       });
  }

  /// Returns the number of samples that grids may have if there are at least `min_bytes` for all samples.
  [[nodiscard]] std::uint64_t grid_samples(std::uint64_t min_bytes) const {
    double triangles = 0.0;
    std::uint64_t taken = 0;
    for (const render::Placement& placement : scene_.placements) {
      triangles += static_cast<double>(placement.mesh->triangle_count);
    }
    for (const BaseSide& side : sides_) {
      taken += side.points.size() * (light::kSampleBytes + (has_directions(side) ? sizeof(std::uint32_t) : 0)) +
               side.blocked.size() * sizeof(std::uint32_t);
    }
    const auto bytes = std::max(min_bytes, static_cast<std::uint64_t>(settings_.bytes_per_triangle * triangles));
    return std::min<std::uint64_t>((bytes - std::min(bytes, taken)) / light::kSampleBytes,
                                   light::TriangleGrid::kMaxOffset);
  }

  [[nodiscard]] Status make_all_grids() {
    std::vector<SeenSide> seen;
    seen.reserve(sides_.size());
    for (const BaseSide& side : sides_) seen.push_back({lit(side), side.triangles});
    GridBudget budget;
    budget.samples = grid_samples(settings_.min_bytes);
    budget.resolving_samples = grid_samples(std::max(settings_.min_bytes, settings_.resolving_bytes));
    budget.is_over = [this] {
      return settings_.max_cpu_seconds > 0.0 && cpu_seconds_.load() > settings_.max_cpu_seconds;
    };
    budget.check_cancelled = [this] { return check_cancelled(); };
    budget.add_cpu_seconds = [this](double seconds) { cpu_seconds_ += seconds; };
    if (progress_) budget.report_progress = [this](double fraction) { progress_(0.6 + 0.4 * fraction); };
    TRY_ASSIGN(fine_, make_grids(seen, settings_, budget, tracers_, stages_));
    return Done{};
  }

  /// Lets paths be traced on misread triangles that no visitor sees, but reflections do.
  void add_misread() {
    for (std::size_t s = 0; s < sides_.size(); ++s) {
      std::vector<std::uint8_t> unseen = sides_[s].misread;
      for (const SeenTriangle& seen : sides_[s].triangles) unseen[seen.triangle] = 0;
      for (std::uint32_t triangle = 0; triangle < unseen.size(); ++triangle) {
        if (unseen[triangle] != 0) fine_[s].unresolved.push_back(triangle);
      }
    }
  }

  /// Encodes light. `seed` randomizes the rounding, so that errors of neighbouring samples cancel.
  [[nodiscard]] std::uint32_t encoded(const Vec3& light, std::uint32_t seed) const {
    return light::to_rgb9e5((light + ambient_) / unit_, render::to_unit_float(render::mix_bits(seed)));
  }

  [[nodiscard]] std::uint8_t coded_error(float error) const { return light::to_error_code(error / unit_); }

  /// Chooses the unit from the direct light. Called once.
  void choose_unit() {
    float brightest = ambient_.maxCoeff();
    for (const BaseSide& side : sides_) {
      for (const PointLight& light : side.light) {
        brightest = std::max(brightest, (light.lamps.light + light.surfaces.light).maxCoeff());
      }
    }
    if (brightest > 0.0f && std::isfinite(brightest)) unit_ = kHeadroom * brightest / light::kMaxRgb9e5;
  }

  /// Returns a store without samples.
  [[nodiscard]] std::shared_ptr<light::LightStore> new_store() const {
    auto store = std::make_shared<light::LightStore>();
    store->scene = key_;
    store->unit = unit_;
    store->settings = fmt::format(
        "{} eyes, {} pixels per degree, {} pixels per sample, {} + {} rays, probe error {}, {} bytes per triangle, "
        "seed {}",
        settings_.eyes, settings_.pixels_per_degree, settings_.pixels_per_sample, settings_.max_light_rays,
        settings_.final_rays, settings_.probe_error, settings_.bytes_per_triangle, settings_.seed);
    store->surfaces.resize(scene_.placements.size());
    return store;
  }

  /// Makes the light computed so far available to rays.
  Status publish() {
    if (published_ == nullptr) choose_unit();
    const std::shared_ptr<light::LightStore> store = new_store();
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
      if (has_directions(side)) add_directions(side, &out);
      if (fine_.empty()) {
        add_grids(side, {{}, side.large}, &out);
      } else {
        add_grids(side, fine_[s], &out);
      }
      stages_.add(std::as_bytes(std::span(out.base)));
      stages_.add(std::as_bytes(std::span(out.grids)));
    }
    published_ = store;
    return renderer_.set_light(published_, "the light just computed");
  }

  void add_directions(const BaseSide& side, light::SideLight* out) const {
    out->directions.reserve(side.light.size());
    for (const PointLight& light : side.light) {
      // Ambient light comes evenly from all directions, so its mean direction is zero.
      const float all = render::luminance(light.lamps.light + light.surfaces.light + ambient_);
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
  const std::size_t group_;
  const Vec3 ambient_;
  const std::function<void(double)>& progress_;
  const std::function<bool()>& cancelled_;
  StageChain& stages_;
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

}  // namespace

Result<BakedLight> bake_group(render::Renderer& renderer, const BakeSettings& settings, std::size_t group,
                              const std::function<void(double)>& progress, const std::function<bool()>& cancelled,
                              StageChain& stages) {
  return Baker(renderer, settings, group, progress, cancelled, stages).run();
}

}  // namespace cyclorama::light_baking
