// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light_baking/triangle_grids.h"

#include <bit>
#include <cmath>
#include <numbers>
#include <optional>

#include "renderfarm/light/light_store.h"
#include "renderfarm/light_baking/grid_light.h"
#include "renderfarm/render/sampler.h"

namespace cyclorama::light_baking {
namespace {

using light::TriangleGrid;
using render::Vec3;

/// Factor on distances to the nearest eye, because visitors may come closer than the sampled eyes.
constexpr double kNearer = 0.7;
/// Minimum parts of a triangle on which light from other surfaces is assumed to vary.
constexpr int kManyParts = 16;
/// Number of standard errors by which probes may differ without counting as different.
constexpr float kSigmas = 2.5f;
/// Fraction by which points at a triangle's corners are moved towards its middle, away from neighbouring triangles.
constexpr float kInwards = 0.02f;
/// Maximum probes per triangle.
constexpr int kMaxProbes = 6;
/// The lamps' light around a triangle is smooth if its range is at most this fraction of the light. If the light is
/// evenly curved over that range, interpolation between vertices errs by an eighth of the range.
constexpr float kSmoothRange = 0.08f;
/// Smooth triangles with fewer visible parts are not probed: a shadow that falls between all vertices is as small as
/// the triangle.
constexpr int kMinSmoothProbed = 8;
/// A grid begins with 1/kStartShare of the parts that visitors could distinguish, up to kMaxStart.
constexpr int kStartShare = 8;
constexpr int kMaxStart = 4;
constexpr int kHugeStart = 16;  ///< Initial parts of the grid of a triangle with at least kHugeParts.
/// Number of probes of a large triangle for light from other surfaces, and of rays per probe.
constexpr int kSurfaceProbes = 3;
constexpr int kSurfaceProbeRays = 16;
/// Parts of the grid for light from other surfaces; a triangle of kHugeParts or more begins with the latter.
constexpr int kSurfaceParts = 4;
constexpr int kHugeSurfaceParts = 16;
constexpr int kHugeParts = 64;
/// Number of visible parts from which a triangle is wide: about 20 degrees of the picture.
constexpr double kWideParts = 128.0;
/// Maximum visible parts per part of a grid; if there are more, paths are traced instead.
constexpr double kMaxCoarseness = 16.0;
const Vec3 kMiddle = Vec3::Constant(1.0f / 3.0f);

Vec3 weights_of(float u, float v) { return {1.0f - u - v, u, v}; }

/// Returns point number `i` of a triangle's probes, which are evenly distributed. They are a folded Sobol sequence. For
/// few points, it is as good as the constructions of Basu and Owen, "Low Discrepancy Constructions in the Triangle",
/// 2015.
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

bool GridInWork::is_huge() const { return visible_parts >= kHugeParts; }

bool GridInWork::is_unresolved() const {
  if (!(squared_error > 0.0f)) return false;
  if (parts > 0) return visible_parts > kMaxCoarseness * parts;
  return visible_parts >= (is_misread ? kMinBlockedParts : kWideParts);
}

int GridInWork::surface_parts() const { return std::min(parts, is_huge() ? kHugeSurfaceParts : kSurfaceParts); }

int GridInWork::next_parts() const {
  if (parts > 0) return 2 * parts;
  if (is_huge()) return std::min(max_parts, kHugeStart);
  if (is_misread) return std::min(max_parts, std::clamp(max_parts / 2, 2, kHugeStart));
  return std::min(max_parts, std::clamp(max_parts / kStartShare, 2, kMaxStart));
}

int GridInWork::step_samples() const {
  return TriangleGrid::samples(next_parts()) - (parts > 0 ? TriangleGrid::samples(parts) : 0);
}

namespace {

class GridMaker {
 public:
  GridMaker(const LitSide& side, const BakeSettings& settings, LightTracer& tracer)
      : side_(side), settings_(settings), tracer_(tracer) {}

  [[nodiscard]] std::vector<GridInWork> probed(std::span<const SeenTriangle> triangles) {
    for (const SeenTriangle& seen : triangles) consider(seen);
    find_blocked_corners();
    probe();
    std::erase_if(candidates_, [](const GridInWork& grid) { return !(grid.squared_error > 0.0f); });
    return std::move(candidates_);
  }

  void advance(GridInWork* grid) {
    if (grid->parts > 0) return halve(grid, [&](std::span<const LightSpot> points) { return lamps_at(points); });
    grid->parts = grid->next_parts();
    grid->light = sampled(*grid, grid->parts);
    grid->rough.assign(grid->light.size(), 1);
    // Errors occur along the edges of shadows, so their area is proportional to the spacing.
    grid->squared_error /= static_cast<float>(grid->parts);
  }

  [[nodiscard]] MadeGrid finished(const GridInWork& work, int max_samples) {
    MadeGrid grid;
    grid.triangle = work.triangle;
    grid.parts = work.parts;
    grid.light = work.light;
    find_separate(&grid);
    add_surfaces(work, max_samples, &grid);
    return grid;
  }

  [[nodiscard]] std::vector<std::uint32_t> misread(std::span<const ProbedTriangle> triangles) {
    std::vector<LightSpot> points;
    std::vector<Vec3> weights;
    for (const ProbedTriangle& probed : triangles) {
      for (int i = 0; i < probed.probes; ++i) {
        weights.push_back(probe_weights(probed.triangle, i));
        points.emplace_back(point(probed.triangle, weights.back(), 500'000u + static_cast<std::uint32_t>(i)));
      }
    }
    const std::vector<ProbeLight> light = lamps_at(points);
    std::vector<std::uint32_t> found;
    std::size_t next = 0;
    for (const ProbedTriangle& probed : triangles) {
      float error = 0.0f;
      float sum = 0.0f;
      for (int i = 0; i < probed.probes; ++i, ++next) {
        const ProbeLight base = base_lamps(probed.triangle, weights[next]);
        const float there = render::luminance(light[next].light);
        error += std::max(0.0f, std::abs(there - render::luminance(base.light)) - light[next].error);
        sum += std::max(there, render::luminance(base.light));
      }
      if (error > kMaxMisread * sum) found.push_back(probed.triangle);
    }
    return found;
  }

  /// Returns 1 for each triangle whose middle is hidden from one of its corners.
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
    GridInWork candidate;
    candidate.triangle = seen.triangle;
    const double most = std::min(parts, static_cast<double>(settings_.max_parts));
    candidate.max_parts = static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::ceil(most))));
    candidate.visible_parts = parts;
    candidate.is_misread = !side_.misread.empty() && side_.misread[seen.triangle] != 0;
    candidate.is_needed = candidate.needs_surfaces = candidate.is_uneven();
    for (const std::size_t base : base_of(seen.triangle)) candidate.is_needed |= !side_.points[base].exists();
    candidate.is_smooth = is_smooth(seen.triangle);
    candidates_.push_back(std::move(candidate));
  }

  [[nodiscard]] bool is_smooth(std::uint32_t triangle) const {
    if (side_.lamp_ranges.empty()) return false;
    float range = 0.0f;
    float light = settings_.dim_light;
    for (const std::size_t base : base_of(triangle)) {
      range = std::max(range, side_.lamp_ranges[base]);
      light += render::luminance(side_.light[base].lamps.light + side_.light[base].surfaces.light) / 3.0f;
    }
    return range <= kSmoothRange * light;
  }

  void find_blocked_corners() {
    std::vector<std::uint32_t> triangles;
    for (const GridInWork& candidate : candidates_) triangles.push_back(candidate.triangle);
    const std::vector<std::uint8_t> blocked = blocked_corners(triangles);
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      candidates_[i].has_blocked_corner = blocked[i] != 0 && candidates_[i].max_parts >= kMinBlockedParts;
      candidates_[i].is_needed |= candidates_[i].has_blocked_corner;
      if (candidates_[i].is_needed) candidates_[i].squared_error = 1.0f;
    }
  }

  /// Returns the lamps' light at points.
  [[nodiscard]] std::vector<ProbeLight> lamps_at(std::span<const LightSpot> points) {
    std::vector<LampLight> lamps(points.size());
    tracer_.from_lamps(points, {settings_.max_grid_light_rays, static_cast<float>(settings_.grid_light_error)}, lamps);
    std::vector<ProbeLight> light(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) light[i] = {lamps[i].light, lamps[i].error};
    return light;
  }

  /// Interpolates between a triangle's base samples. `part` selects a member of PointLight.
  template <typename Part>
  [[nodiscard]] ProbeLight interpolated_base(std::uint32_t triangle, const Vec3& weights, const Part& part) const {
    ProbeLight sum;
    const std::array<std::size_t, 3> base = base_of(triangle);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& light = part(side_.light[base[i]]);
      sum.light += weights[static_cast<Eigen::Index>(i)] * light.light;
      sum.error += weights[static_cast<Eigen::Index>(i)] * light.error;
    }
    return sum;
  }
  [[nodiscard]] ProbeLight base_lamps(std::uint32_t triangle, const Vec3& weights) const {
    return interpolated_base(
        triangle, weights, [](const PointLight& light) -> const auto& { return light.lamps; });
  }
  [[nodiscard]] ProbeLight base_surfaces(std::uint32_t triangle, const Vec3& weights) const {
    return interpolated_base(
        triangle, weights, [](const PointLight& light) -> const auto& { return light.surfaces; });
  }
  /// Returns the luminance of all interpolated light at a point.
  [[nodiscard]] float all_light(std::uint32_t triangle, const Vec3& weights) const {
    return render::luminance(base_lamps(triangle, weights).light + base_surfaces(triangle, weights).light);
  }

  /// Returns the difference between two samples in excess of their noise, relative to `light` plus `dim_light`.
  [[nodiscard]] float difference(const ProbeLight& a, const ProbeLight& b, float light) const {
    const float noise = kSigmas * std::hypot(a.error, b.error);
    const float found = std::abs(render::luminance(a.light) - render::luminance(b.light));
    const float scale = light + settings_.dim_light;
    return found > noise && scale > 0.0f ? (found - noise) / scale : 0.0f;
  }
  [[nodiscard]] bool is_error(float difference) const { return difference > static_cast<float>(settings_.probe_error); }

  [[nodiscard]] static bool is_large(const GridInWork& candidate) { return candidate.max_parts >= kManyParts; }
  [[nodiscard]] static int probes_of(const GridInWork& candidate) {
    if (candidate.is_smooth && !is_large(candidate)) return candidate.max_parts < kMinSmoothProbed ? 0 : 1;
    return std::clamp(candidate.max_parts / 4, 2, kMaxProbes);
  }

  /// A point at which the light is compared with that interpolated from the vertices.
  struct Probe {
    std::size_t candidate;
    Vec3 weights;
  };

  /// Compares the light at points inside the triangles with that of the vertices.
  void probe() {
    std::vector<LightSpot> points;
    std::vector<Probe> probes;
    for (std::size_t c = 0; c < candidates_.size(); ++c) {
      const GridInWork& candidate = candidates_[c];
      if (candidate.is_needed) continue;
      for (int i = 0; i < probes_of(candidate); ++i) {
        probes.push_back({c, probe_weights(candidate.triangle, i)});
        points.emplace_back(point(candidate.triangle, probes.back().weights, 1u + static_cast<std::uint32_t>(i)));
      }
    }
    const std::vector<ProbeLight> light = lamps_at(points);
    for (std::size_t i = 0; i < probes.size(); ++i) {
      GridInWork& candidate = candidates_[probes[i].candidate];
      ProbeLight base = base_lamps(candidate.triangle, probes[i].weights);
      // The sites of a large triangle's vertices are far apart, so their scatter does not measure noise.
      if (is_large(candidate)) base.error = 0.0f;
      const float found = difference(light[i], base, all_light(candidate.triangle, probes[i].weights));
      if (is_error(found)) candidate.squared_error += found * found / static_cast<float>(probes_of(candidate));
    }
    probe_surfaces(points, probes);
  }

  /// Compares the light from other surfaces, which is noisy but smooth, at some of the probes. The mean squared
  /// difference in excess of the noise counts as an error.
  void probe_surfaces(std::span<const LightSpot> points, std::span<const Probe> probes) {
    std::vector<LightSpot> chosen_points;
    std::vector<Probe> chosen;
    std::vector<int> count(candidates_.size(), 0);
    for (std::size_t i = 0; i < probes.size(); ++i) {
      if (!is_large(candidates_[probes[i].candidate]) || count[probes[i].candidate] == kSurfaceProbes) continue;
      ++count[probes[i].candidate];
      chosen_points.push_back(points[i]);
      chosen.push_back(probes[i]);
    }
    std::vector<GatheredLight> light(chosen.size());
    tracer_.from_surfaces(chosen_points, settings_.gathering(kSurfaceProbeRays, side_.bounces), light);
    std::vector<float> error(candidates_.size(), 0.0f);
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      const std::uint32_t triangle = candidates_[chosen[i].candidate].triangle;
      const ProbeLight base = base_surfaces(triangle, chosen[i].weights);
      const float found = render::luminance(light[i].light - base.light);
      const float scale = all_light(triangle, chosen[i].weights) + settings_.dim_light;
      const float noise = light[i].error * light[i].error + base.error * base.error;
      if (scale > 0.0f) error[chosen[i].candidate] += (found * found - noise) / (scale * scale);
    }
    for (std::size_t c = 0; c < candidates_.size(); ++c) {
      if (count[c] == 0) continue;
      const float squared = error[c] / static_cast<float>(count[c]);
      if (!(squared > 0.0f && is_error(std::sqrt(squared)))) continue;
      candidates_[c].needs_surfaces = true;
      candidates_[c].squared_error += squared;
    }
  }

  /// Halves the spacing of the samples. New samples are computed by light_at(points) next to rough ones and
  /// interpolated elsewhere, so the cost is proportional to the length of the shadows' edges.
  template <typename LightAt>
  void halve(GridInWork* grid, const LightAt& light_at) {
    const int parts = 2 * grid->parts;
    const auto count = static_cast<std::size_t>(TriangleGrid::samples(parts));
    std::vector<ProbeLight> finer(count);
    std::vector<std::uint8_t> rough(count, 0);
    struct Midpoint {
      std::size_t at, a, b;  ///< Indices in the finer grid.
    };
    std::vector<Midpoint> active;
    std::vector<LightSpot> points;
    for_each_sample(grid->parts, [&](int i, int j) {
      finer[static_cast<std::size_t>(TriangleGrid::index(parts, 2 * i, 2 * j))] =
          grid->light[static_cast<std::size_t>(TriangleGrid::index(grid->parts, i, j))];
    });
    for_each_pair(grid->parts, [&](int i, int j, int k, int l) {
      const auto old_a = static_cast<std::size_t>(TriangleGrid::index(grid->parts, i, j));
      const auto old_b = static_cast<std::size_t>(TriangleGrid::index(grid->parts, k, l));
      const auto at = static_cast<std::size_t>(TriangleGrid::index(parts, i + k, j + l));
      finer[at] = mean(grid->light[old_a], grid->light[old_b]);
      if (grid->rough[old_a] == 0 && grid->rough[old_b] == 0) return;
      active.push_back({at, static_cast<std::size_t>(TriangleGrid::index(parts, 2 * i, 2 * j)),
                        static_cast<std::size_t>(TriangleGrid::index(parts, 2 * k, 2 * l))});
      points.emplace_back(
          point(grid->triangle, grid_weights(parts, i + k, j + l), 1000u + static_cast<std::uint32_t>(at)));
    });
    const std::vector<ProbeLight> light = light_at(points);
    const float middle = all_light(grid->triangle, kMiddle);
    double sum = 0.0;
    for (std::size_t k = 0; k < active.size(); ++k) {
      ProbeLight& expected = finer[active[k].at];
      const float found = difference(light[k], expected, std::max(render::luminance(expected.light), middle));
      if (!is_error(found)) {
        expected = mean(expected, light[k]);  // Half of the noise.
        continue;
      }
      rough[active[k].at] = rough[active[k].a] = rough[active[k].b] = 1;
      sum += static_cast<double>(found) * static_cast<double>(found);
      expected = light[k];
    }
    const auto midpoints = static_cast<double>(count - grid->light.size());
    grid->squared_error = static_cast<float>(0.5 * sum / midpoints);
    if (sum == 0.0) return;  // The finer grid would be the same.
    grid->parts = parts;
    grid->light = std::move(finer);
    grid->rough = std::move(rough);
  }

  [[nodiscard]] static Vec3 grid_weights(int parts, int i, int j) {
    const auto scale = 1.0f / static_cast<float>(parts);
    // Corners are moved inwards slightly, away from the neighbouring triangles.
    const Vec3 weights = weights_of(static_cast<float>(i) * scale, static_cast<float>(j) * scale);
    const float inwards = kInwards * scale;
    return weights * (1.0f - inwards) + Vec3::Constant(inwards / 3.0f);
  }

  [[nodiscard]] std::vector<LightSpot> grid_points(const GridInWork& candidate, int parts, std::uint32_t number) const {
    std::vector<LightSpot> points;
    for_each_sample(parts, [&](int i, int j) {
      const auto index = static_cast<std::uint32_t>(points.size());
      points.emplace_back(point(candidate.triangle, grid_weights(parts, i, j), number + index));
    });
    return points;
  }

  [[nodiscard]] std::vector<ProbeLight> sampled(const GridInWork& candidate, int parts) {
    return lamps_at(grid_points(candidate, parts, 100));
  }

  /// Adds light that comes from other surfaces. Since it is smooth, small triangles interpolate it from their vertices,
  /// unless those are hidden; other triangles use a separate grid.
  void add_surfaces(const GridInWork& candidate, int max_samples, MadeGrid* grid) {
    const std::array<std::size_t, 3> base = base_of(candidate.triangle);
    bool from_base = !candidate.needs_surfaces && !candidate.has_blocked_corner && !side_.per_triangle;
    for (const std::size_t i : base) from_base &= side_.points[i].exists();
    if (from_base) {
      std::vector<ProbeLight> light;
      light.reserve(base.size());
      for (const std::size_t i : base) {
        light.push_back({side_.light[i].surfaces.light, side_.light[i].surfaces.error});
      }
      return add(1, light, grid);
    }
    // Interpolation in a coarse grid would let light through an object that stands on the triangle.
    const bool is_cut = std::ranges::count(grid->separate, 1) > 0;
    const GridInWork surfaces = is_cut ? surfaces_on(candidate, grid->parts, grid->separate, max_samples)
                                       : surfaces_on(candidate, candidate.surface_parts(), {}, max_samples);
    while (grid->parts < surfaces.parts) refine(grid);
    add(surfaces.parts, surfaces.light, grid);
  }

  /// Samples light from other surfaces on a grid of `parts`, and more finely where it varies on an uneven triangle.
  [[nodiscard]] GridInWork surfaces_on(const GridInWork& candidate, int parts, std::span<const std::uint8_t> separate,
                                       int max_samples) {
    // Few samples cover a large part of the picture, so their noise would show; many lie close together.
    const int rays = std::max(1, settings_.final_rays / (parts <= kHugeSurfaceParts ? 2 : 4));
    const auto gathered_at = [&](std::span<const LightSpot> points) {
      std::vector<GatheredLight> gathered(points.size());
      tracer_.from_surfaces(points, settings_.gathering(rays, side_.bounces), gathered);
      return gathered;
    };
    GridInWork grid;
    grid.triangle = candidate.triangle;
    grid.parts = parts;
    grid.light = smoothed(separate, parts, gathered_at(grid_points(candidate, parts, 10'000)));
    grid.rough.assign(grid.light.size(), 1);
    grid.squared_error = candidate.is_uneven() ? 1.0f : 0.0f;
    while (grid.squared_error > 0.0f && grid.parts < candidate.max_parts &&
           TriangleGrid::samples(2 * grid.parts) <= max_samples) {
      halve(&grid, [&](std::span<const LightSpot> points) { return as_probes(gathered_at(points)); });
    }
    return grid;
  }

  /// Marks samples that are hidden from a neighbour: one of the two is inside or behind an object that stands on the
  /// triangle, so light must not be interpolated between them.
  void find_separate(MadeGrid* grid) {
    grid->separate.assign(grid->light.size(), 0);
    std::vector<std::array<int, 2>> ends;
    std::vector<std::array<Vec3, 2>> pairs;
    const auto position = [&](int i, int j) {
      return point(grid->triangle, grid_weights(grid->parts, i, j), 0).position;
    };
    for_each_pair(grid->parts, [&](int i, int j, int k, int l) {
      ends.push_back({TriangleGrid::index(grid->parts, i, j), TriangleGrid::index(grid->parts, k, l)});
      pairs.push_back({position(i, j), position(k, l)});
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
  std::vector<GridInWork> candidates_;
};

}  // namespace

std::vector<std::uint32_t> find_blocked(const LitSide& side, std::span<const std::uint32_t> triangles,
                                        LightTracer& tracer) {
  const BakeSettings none;
  const std::vector<std::uint8_t> blocked = GridMaker(side, none, tracer).blocked_corners(triangles);
  std::vector<std::uint32_t> found;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (blocked[i] != 0) found.push_back(triangles[i]);
  }
  return found;
}

std::vector<std::uint32_t> find_misread(const LitSide& side, std::span<const ProbedTriangle> triangles,
                                        const BakeSettings& settings, LightTracer& tracer) {
  return GridMaker(side, settings, tracer).misread(triangles);
}

std::vector<GridInWork> probe_triangles(const LitSide& side, std::span<const SeenTriangle> triangles,
                                        const BakeSettings& settings, LightTracer& tracer) {
  return GridMaker(side, settings, tracer).probed(triangles);
}

void advance_grid(const LitSide& side, const BakeSettings& settings, LightTracer& tracer, GridInWork* grid) {
  GridMaker(side, settings, tracer).advance(grid);
}

MadeGrid finished_grid(const LitSide& side, const GridInWork& grid, int max_samples, const BakeSettings& settings,
                       LightTracer& tracer) {
  return GridMaker(side, settings, tracer).finished(grid, max_samples);
}

}  // namespace cyclorama::light_baking
