// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light_baking/triangle_grids.h"

#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

#include "renderfarm/light/light_store.h"
#include "renderfarm/render/sampler.h"

namespace cyclorama::light_baking {
namespace {

using light::TriangleGrid;
using render::Vec3;

/// Eyes are tried at some places only; a visitor may come nearer than any of them.
constexpr double kNearer = 0.7;
/// From this many parts on, light that comes from other surfaces also varies within the triangle.
constexpr int kManyParts = 16;
/// Probes may differ by this many standard errors before they count.
constexpr float kSigmas = 2.5f;
/// Points near a triangle's corners for visibility tests lie this far towards its middle.
constexpr float kInwards = 0.02f;
constexpr int kMaxProbes = 16;
/// A grid begins with this share of the parts that visitors could see, up to kMaxStart.
constexpr int kStartShare = 4;
constexpr int kMaxStart = 8;
/// Parts of the grid for light from other surfaces, and those on triangles of kHugeParts or more.
constexpr int kSurfaceParts = 4;
constexpr int kHugeSurfaceParts = 16;
constexpr int kHugeParts = 64;
/// Steps from a sample to neighbours, such that each pair is met once.
constexpr std::array<std::pair<int, int>, 3> kNeighbours = {{{1, 0}, {0, 1}, {-1, 1}}};
const Vec3 kMiddle = Vec3::Constant(1.0f / 3.0f);

struct Candidate {
  std::uint32_t triangle = 0;
  int max_parts = 1;
  int probes = 0;
  bool needs_grid = false;
  bool has_blocked_corner = false;
};

struct ProbeLight {
  Vec3 light = Vec3::Zero();
  float error = 0.0f;
};

Vec3 weights_of(float u, float v) { return {1.0f - u - v, u, v}; }

/// Returns point number `i` of a triangle's probes, evenly distributed. Source: Basu and Owen, "Low Discrepancy
/// Constructions in the Triangle", 2015, replaced by a folded Sobol sequence, which is as good for a few points.
Vec3 probe_weights(std::uint32_t seed, int i) {
  const render::SobolPoint at = render::sobol_point(render::reversed_bits(static_cast<std::uint32_t>(i)), seed, 0);
  return at.u + at.v > 1.0f ? weights_of(1.0f - at.u, 1.0f - at.v) : weights_of(at.u, at.v);
}

}  // namespace

double visible_parts(const render::Placement& placement, const SeenTriangle& seen, const BakeSettings& settings) {
  const std::array<Vec3, 3> c = corners_of(placement, seen.triangle);
  const float edge = std::max({(c[1] - c[0]).norm(), (c[2] - c[1]).norm(), (c[0] - c[2]).norm()});
  const double pixel_rad = std::numbers::pi / 180.0 / settings.pixels_per_degree;
  return static_cast<double>(edge) /
         (kNearer * static_cast<double>(seen.distance) * settings.pixels_per_sample * pixel_rad);
}

namespace {

class GridMaker {
 public:
  GridMaker(const LitSide& side, const BakeSettings& settings, LightTracer& tracer)
      : side_(side), settings_(settings), tracer_(tracer) {}

  [[nodiscard]] std::vector<MadeGrid> run(std::span<const SeenTriangle> triangles) {
    for (const SeenTriangle& seen : triangles) consider(seen);
    find_blocked_corners();
    probe();
    std::vector<MadeGrid> grids;
    for (const Candidate& candidate : candidates_) {
      if (candidate.needs_grid) grids.push_back(refined(candidate));
    }
    return grids;
  }

  /// Returns 1 for each triangle of which a corner does not see the middle.
  [[nodiscard]] std::vector<std::uint8_t> blocked_corners(std::span<const std::uint32_t> triangles) {
    std::vector<std::array<Vec3, 2>> pairs;
    for (const std::uint32_t triangle : triangles) {
      const LightPoint middle = point(triangle, kMiddle, 0);
      for (int i = 0; i < 3; ++i) {
        const Vec3 weights = Vec3::Constant(kInwards / 3.0f) + Vec3::Unit(i) * (1.0f - kInwards);
        pairs.push_back({middle.position, point(triangle, weights, 0).position});
      }
    }
    std::vector<std::uint8_t> visible(pairs.size());
    tracer_.find_visible(pairs, visible);
    std::vector<std::uint8_t> blocked(triangles.size());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (visible[i] == 0) blocked[i / 3] = 1;
    }
    return blocked;
  }

 private:
  [[nodiscard]] LightPoint point(std::uint32_t triangle, const Vec3& weights, std::uint32_t number) const {
    const std::uint32_t seed = render::mix_bits(triangle * 0x9e3779b9u + number);
    const LightPoint front = point_in(*side_.placement, triangle, weights, seed);
    return side_.back ? other_side(front) : front;
  }

  [[nodiscard]] std::array<std::size_t, 3> base_of(std::uint32_t triangle) const {
    if (side_.per_triangle) return {triangle, triangle, triangle};
    const std::array<std::uint32_t, 3>& corners = side_.placement->mesh->triangles[triangle];
    return {corners[0], corners[1], corners[2]};
  }

  void consider(const SeenTriangle& seen) {
    const double parts = visible_parts(*side_.placement, seen, settings_);
    if (!(parts > 1.0) || settings_.max_parts <= 1) return;
    Candidate candidate;
    candidate.triangle = seen.triangle;
    const double most = std::min(parts, static_cast<double>(settings_.max_parts));
    candidate.max_parts = static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::ceil(most))));
    candidate.probes = std::clamp(candidate.max_parts / 2, 2, kMaxProbes);
    for (const std::size_t base : base_of(seen.triangle)) candidate.needs_grid |= !side_.points[base].exists();
    candidates_.push_back(candidate);
  }

  void find_blocked_corners() {
    std::vector<std::uint32_t> triangles;
    for (const Candidate& candidate : candidates_) triangles.push_back(candidate.triangle);
    const std::vector<std::uint8_t> blocked = blocked_corners(triangles);
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      candidates_[i].has_blocked_corner = blocked[i] != 0 && candidates_[i].max_parts >= kMinBlockedParts;
      candidates_[i].needs_grid |= candidates_[i].has_blocked_corner;
    }
  }

  /// Returns light at points: that of lamps and, if rays are given, that of other surfaces.
  [[nodiscard]] std::vector<ProbeLight> light_at(std::span<const LightPoint> points, int surface_rays) {
    std::vector<LampLight> lamps(points.size());
    tracer_.from_lamps(points, {settings_.max_grid_light_rays, static_cast<float>(settings_.grid_light_error)}, lamps);
    std::vector<GatheredLight> surfaces(points.size());
    if (surface_rays > 0) tracer_.from_surfaces(points, surface_rays, side_.only_lamps, surfaces);
    std::vector<ProbeLight> light(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) light[i] = {lamps[i].light + surfaces[i].light, lamps[i].error};
    return light;
  }

  [[nodiscard]] ProbeLight base_light(std::uint32_t triangle, const Vec3& weights, bool with_surfaces) const {
    ProbeLight sum;
    const std::array<std::size_t, 3> base = base_of(triangle);
    for (std::size_t i = 0; i < 3; ++i) {
      const PointLight& light = side_.light[base[i]];
      const float weight = weights[static_cast<Eigen::Index>(i)];
      sum.light += weight * light.lamps.light;
      if (with_surfaces) sum.light += weight * light.surfaces.light;
      sum.error += weight * light.lamps.error;
    }
    return sum;
  }

  [[nodiscard]] bool differ(const ProbeLight& a, const ProbeLight& b, float light) const {
    const float error = std::hypot(a.error, b.error);
    return std::abs(render::luminance(a.light) - render::luminance(b.light)) >
           static_cast<float>(settings_.probe_error) * (light + settings_.dim_light) + kSigmas * error;
  }

  [[nodiscard]] static bool is_large(const Candidate& candidate) { return candidate.max_parts >= kManyParts; }

  /// Compares light at points inside the triangles with that of their vertices.
  void probe() {
    for (const bool large : {false, true}) {
      std::vector<LightPoint> points;
      std::vector<std::pair<std::size_t, Vec3>> places;
      for (std::size_t c = 0; c < candidates_.size(); ++c) {
        const Candidate& candidate = candidates_[c];
        if (candidate.needs_grid || is_large(candidate) != large) continue;
        for (int i = 0; i < candidate.probes; ++i) {
          const Vec3 weights = probe_weights(candidate.triangle, i);
          points.push_back(point(candidate.triangle, weights, 1u + static_cast<std::uint32_t>(i)));
          places.emplace_back(c, weights);
        }
      }
      const std::vector<ProbeLight> light = light_at(points, large ? std::max(1, settings_.final_rays / 4) : 0);
      for (std::size_t i = 0; i < points.size(); ++i) {
        Candidate& candidate = candidates_[places[i].first];
        const Vec3& weights = places[i].second;
        const ProbeLight base = base_light(candidate.triangle, weights, large);
        const float all = render::luminance(base_light(candidate.triangle, weights, true).light);
        candidate.needs_grid |= differ(light[i], base, all);
      }
    }
  }

  /// Samples of a grid while it is refined. `rough` marks samples beside which light varies more than linearly.
  struct Level {
    int parts = 1;
    std::vector<ProbeLight> light;
    std::vector<std::uint8_t> rough;
  };

  /// Halves the spacing until light is linear between the samples, or until they are as dense as a visitor can see.
  /// Where it is linear already, samples are interpolated, so the cost grows with the length of shadows' edges.
  [[nodiscard]] MadeGrid refined(const Candidate& candidate) {
    const int start = std::min(candidate.max_parts, std::clamp(candidate.max_parts / kStartShare, 2, kMaxStart));
    Level level;
    level.parts = start;
    level.light = sampled(candidate, start);
    level.rough.assign(level.light.size(), 1);
    while (level.parts < candidate.max_parts) {
      Level finer = halved(candidate, level);
      const bool is_smooth = std::ranges::count(finer.rough, 1) == 0;
      if (is_smooth) break;
      level = std::move(finer);
    }
    MadeGrid grid;
    grid.triangle = candidate.triangle;
    grid.parts = level.parts;
    grid.light.reserve(level.light.size());
    for (const ProbeLight& sample : level.light) grid.light.push_back(sample.light);
    find_separate(&grid);
    add_surfaces(candidate, &grid);
    return grid;
  }

  /// Returns the samples of twice as many parts, computed beside rough ones and interpolated elsewhere.
  [[nodiscard]] Level halved(const Candidate& candidate, const Level& level) {
    Level finer;
    finer.parts = 2 * level.parts;
    const auto count = static_cast<std::size_t>(TriangleGrid::samples(finer.parts));
    finer.light.resize(count);
    finer.rough.assign(count, 0);
    struct Midpoint {
      std::size_t at, a, b;  ///< Indices in the finer grid.
    };
    std::vector<Midpoint> active;
    std::vector<LightPoint> points;
    for_each_sample(level.parts, [&](int i, int j) {
      const auto old = static_cast<std::size_t>(TriangleGrid::index(level.parts, i, j));
      const auto here = static_cast<std::size_t>(TriangleGrid::index(finer.parts, 2 * i, 2 * j));
      finer.light[here] = level.light[old];
      for (const auto& [di, dj] : kNeighbours) {
        if (i + di < 0 || i + di + j + dj > level.parts) continue;
        const auto other = static_cast<std::size_t>(TriangleGrid::index(level.parts, i + di, j + dj));
        const auto b = static_cast<std::size_t>(TriangleGrid::index(finer.parts, 2 * (i + di), 2 * (j + dj)));
        const auto at = static_cast<std::size_t>(TriangleGrid::index(finer.parts, 2 * i + di, 2 * j + dj));
        finer.light[at] = mean(level.light[old], level.light[other]);
        if (level.rough[old] == 0 && level.rough[other] == 0) continue;
        active.push_back({at, here, b});
        points.push_back(point(candidate.triangle, grid_weights(finer.parts, 2 * i + di, 2 * j + dj),
                               1000u + static_cast<std::uint32_t>(at)));
      }
    });
    const std::vector<ProbeLight> light = light_at(points, 0);
    for (std::size_t k = 0; k < active.size(); ++k) {
      const Midpoint& midpoint = active[k];
      ProbeLight& expected = finer.light[midpoint.at];
      const float all = std::max(render::luminance(expected.light),
                                 render::luminance(base_light(candidate.triangle, kMiddle, true).light));
      if (differ(light[k], expected, all))
        finer.rough[midpoint.at] = finer.rough[midpoint.a] = finer.rough[midpoint.b] = 1;
      expected = light[k];
    }
    return finer;
  }

  [[nodiscard]] static ProbeLight mean(const ProbeLight& a, const ProbeLight& b) {
    return {0.5f * (a.light + b.light), 0.5f * (a.error + b.error)};
  }

  [[nodiscard]] static Vec3 grid_weights(int parts, int i, int j) {
    const auto scale = 1.0f / static_cast<float>(parts);
    // Corners are drawn in a little, off the neighbouring triangles.
    const Vec3 weights = weights_of(static_cast<float>(i) * scale, static_cast<float>(j) * scale);
    const float inwards = kInwards * scale;
    return weights * (1.0f - inwards) + Vec3::Constant(inwards / 3.0f);
  }

  template <typename Visit>
  static void for_each_sample(int parts, Visit visit) {
    for (int j = 0; j <= parts; ++j) {
      for (int i = 0; i + j <= parts; ++i) visit(i, j);
    }
  }

  [[nodiscard]] std::vector<LightPoint> grid_points(const Candidate& candidate, int parts, std::uint32_t number) const {
    std::vector<LightPoint> points;
    for_each_sample(parts, [&](int i, int j) {
      const auto index = static_cast<std::uint32_t>(points.size());
      points.push_back(point(candidate.triangle, grid_weights(parts, i, j), number + index));
    });
    return points;
  }

  [[nodiscard]] std::vector<ProbeLight> sampled(const Candidate& candidate, int parts) {
    return light_at(grid_points(candidate, parts, 100), 0);
  }

  /// Returns light at a place between samples.
  [[nodiscard]] static Vec3 interpolated(const std::vector<Vec3>& light, int parts, float u, float v) {
    const int j = std::min(static_cast<int>(v), parts - 1);
    const int i = std::min(static_cast<int>(u), parts - 1 - j);
    u -= static_cast<float>(i);
    v -= static_cast<float>(j);
    const auto at = [&](int column, int row) -> const Vec3& {
      return light[static_cast<std::size_t>(TriangleGrid::index(parts, column, row))];
    };
    if (u + v <= 1.0f || i + j == parts - 1) return at(i, j) * (1.0f - u - v) + at(i + 1, j) * u + at(i, j + 1) * v;
    return at(i + 1, j + 1) * (u + v - 1.0f) + at(i, j + 1) * (1.0f - u) + at(i + 1, j) * (1.0f - v);
  }

  /// Adds light that comes from other surfaces. It is smooth: small triangles have it from their vertices, unless those
  /// are hidden; others from a coarse grid of its own.
  void add_surfaces(const Candidate& candidate, MadeGrid* grid) {
    const std::array<std::size_t, 3> base = base_of(candidate.triangle);
    bool from_base = !is_large(candidate) && !candidate.has_blocked_corner && !side_.per_triangle;
    for (const std::size_t i : base) from_base &= side_.points[i].exists();
    int parts = 1;
    std::vector<Vec3> light;
    if (from_base) {
      for (const std::size_t i : base) light.push_back(side_.light[i].surfaces.light);
    } else {
      parts = std::min(grid->parts, candidate.max_parts >= kHugeParts ? kHugeSurfaceParts : kSurfaceParts);
      // A coarse grid would carry light through what stands on the triangle.
      if (std::ranges::count(grid->separate, 1) > 0) parts = grid->parts;
      const std::vector<LightPoint> points = grid_points(candidate, parts, 10'000);
      std::vector<GatheredLight> gathered(points.size());
      // Few samples cover a large part of the picture, so their noise would show; many lie close together.
      const int rays = parts <= kHugeSurfaceParts ? settings_.final_rays : std::max(1, settings_.final_rays / 4);
      tracer_.from_surfaces(points, rays, side_.only_lamps, gathered);
      for (const GatheredLight& sample : gathered) light.push_back(sample.light);
    }
    std::size_t index = 0;
    const float scale = static_cast<float>(parts) / static_cast<float>(grid->parts);
    for_each_sample(grid->parts, [&](int i, int j) {
      grid->light[index++] += interpolated(light, parts, static_cast<float>(i) * scale, static_cast<float>(j) * scale);
    });
  }

  /// Marks samples that are hidden from a neighbour: one of both is inside or behind something that stands on the
  /// triangle, and light must not leak between them.
  void find_separate(MadeGrid* grid) {
    grid->separate.assign(grid->light.size(), 0);
    std::vector<std::array<int, 2>> ends;
    std::vector<std::array<Vec3, 2>> pairs;
    const auto position = [&](int i, int j) {
      return point(grid->triangle, grid_weights(grid->parts, i, j), 0).position;
    };
    for_each_sample(grid->parts, [&](int i, int j) {
      const int here = TriangleGrid::index(grid->parts, i, j);
      for (const auto& [di, dj] : kNeighbours) {
        if (i + di < 0 || i + di + j + dj > grid->parts) continue;
        ends.push_back({here, TriangleGrid::index(grid->parts, i + di, j + dj)});
        pairs.push_back({position(i, j), position(i + di, j + dj)});
      }
    });
    std::vector<std::uint8_t> visible(pairs.size());
    tracer_.find_visible(pairs, visible);
    for (std::size_t p = 0; p < pairs.size(); ++p) {
      if (visible[p] != 0) continue;
      for (const int end : ends[p]) grid->separate[static_cast<std::size_t>(end)] = 1;
    }
  }

  const LitSide& side_;
  const BakeSettings& settings_;
  LightTracer& tracer_;
  std::vector<Candidate> candidates_;
};

}  // namespace

void find_blocked(const LitSide& side, std::uint32_t first, LightTracer& tracer, std::span<std::uint8_t> ret) {
  std::vector<std::uint32_t> triangles(ret.size());
  std::iota(triangles.begin(), triangles.end(), first);
  const BakeSettings none;
  std::ranges::copy(GridMaker(side, none, tracer).blocked_corners(triangles), ret.begin());
}

std::vector<MadeGrid> make_grids(const LitSide& side, std::span<const SeenTriangle> triangles,
                                 const BakeSettings& settings, LightTracer& tracer) {
  return GridMaker(side, settings, tracer).run(triangles);
}

}  // namespace cyclorama::light_baking
