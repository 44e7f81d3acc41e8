// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light_baking/vertex_sites.h"

#include <algorithm>

#include "renderfarm/render/sampler.h"

namespace cyclorama::light_baking {
namespace {

using render::Vec3;

/// Weight of a site's own corner: the mean of the corner's barycentric weight over the triangle, weighted by itself.
constexpr float kOwnCorner = 0.5f;
/// A moved site keeps this fraction of the unobstructed line as its distance from the obstacle; its weight is
/// multiplied by kMovedWeight.
constexpr float kClearance = 0.1f;
constexpr float kMovedWeight = 1e-6f;

Vec3 site_weights(std::size_t corner) {
  Vec3 weights = Vec3::Constant(0.5f * (1.0f - kOwnCorner));
  weights[static_cast<Eigen::Index>(corner)] = kOwnCorner;
  return weights;
}

LightPoint point_on(const render::Placement& placement, const BaseSide& side, std::uint32_t triangle,
                    const Vec3& weights, std::uint32_t seed) {
  const LightPoint front = point_in(placement, triangle, weights, seed);
  return side.back ? other_side(front) : front;
}

float area_of(const render::Placement& placement, std::uint32_t triangle) {
  const std::array<Vec3, 3> c = corners_of(placement, triangle);
  const float area = (c[1] - c[0]).cross(c[2] - c[0]).norm();
  return area > 0.0f && std::isfinite(area) ? area : 0.0f;
}

}  // namespace

std::vector<VertexSite> find_sites(const render::TraceScene& scene, const BaseSide& side,
                                   std::span<const SeenTriangle> triangles, LightTracer& tracer) {
  const render::Placement& placement = scene.placements[side.placement];
  std::vector<VertexSite> sites;
  std::vector<std::array<Vec3, 2>> pairs;
  for (const SeenTriangle& seen : triangles) {
    const Vec3 from = point_on(placement, side, seen.triangle, seen.seen_at, 0).position;
    const float area = area_of(placement, seen.triangle);
    for (std::size_t corner = 0; corner < 3; ++corner) {
      sites.push_back({seen.triangle, site_weights(corner), area});
      pairs.push_back({from, point_on(placement, side, seen.triangle, sites.back().weights, 0).position});
    }
  }
  std::vector<std::uint8_t> visible(pairs.size());
  tracer.find_visible(pairs, visible);
  std::vector<std::size_t> blocked;
  std::vector<std::array<Vec3, 2>> blocked_pairs;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (visible[i] != 0) continue;
    blocked.push_back(i);
    blocked_pairs.push_back(pairs[i]);
  }
  std::vector<float> free(blocked.size());
  tracer.find_free_share(blocked_pairs, free);
  for (std::size_t k = 0; k < blocked.size(); ++k) {
    VertexSite& site = sites[blocked[k]];
    const Vec3& from = triangles[blocked[k] / 3].seen_at;
    site.weights = from + (1.0f - kClearance) * free[k] * (site.weights - from);
    site.area *= kMovedWeight;
  }
  return sites;
}

std::size_t assign_sites(const render::Placement& placement, std::span<const VertexSite> sites, BaseSide* side) {
  const auto& triangles = placement.mesh->triangles;
  side->site_begin.assign(side->points.size() + 1, 0);
  for (std::size_t i = 0; i < sites.size(); ++i) ++side->site_begin[triangles[sites[i].triangle][i % 3] + 1];
  for (std::size_t v = 0; v + 1 < side->site_begin.size(); ++v) side->site_begin[v + 1] += side->site_begin[v];
  side->sites.resize(sites.size());
  std::vector<std::uint32_t> next(side->site_begin.begin(), side->site_begin.end() - 1);
  for (std::size_t i = 0; i < sites.size(); ++i) side->sites[next[triangles[sites[i].triangle][i % 3]]++] = sites[i];
  std::size_t hidden = 0;
  for (std::size_t v = 0; v + 1 < side->site_begin.size(); ++v) {
    const std::uint32_t begin = side->site_begin[v];
    const std::uint32_t end = side->site_begin[v + 1];
    const bool is_hidden =
        begin < end && std::all_of(side->sites.begin() + begin, side->sites.begin() + end, [&](const VertexSite& site) {
          return site.area < area_of(placement, site.triangle);
        });
    if (is_hidden) ++hidden;
  }
  return hidden;
}

LightSpot spot_of(const render::Placement& placement, const BaseSide& side, std::uint32_t sample) {
  LightSpot spot;
  spot.seed = side.points[sample].seed;
  if (!side.site_begin.empty()) {
    float sum = 0.0f;
    for (std::uint32_t i = side.site_begin[sample]; i < side.site_begin[sample + 1]; ++i) {
      const VertexSite& site = side.sites[i];
      const LightPoint point = point_on(placement, side, site.triangle, site.weights, spot.seed);
      if (!point.exists() || !(site.area > 0.0f)) continue;
      sum += site.area;
      spot.points.push_back(point);
      spot.weights_up_to.push_back(sum);
    }
  }
  if (spot.points.empty()) spot = LightSpot(side.points[sample]);
  return spot;
}

void sharpen(const render::Placement& placement, BaseSide* side) {
  if (side->site_begin.empty()) return;
  const auto& triangles = placement.mesh->triangles;
  const std::size_t count = side->points.size();
  std::vector<Vec3> lamps(count, Vec3::Zero());
  std::vector<Vec3> surfaces(count, Vec3::Zero());
  for (std::size_t v = 0; v < count; ++v) {
    float area = 0.0f;
    for (std::uint32_t i = side->site_begin[v]; i < side->site_begin[v + 1]; ++i) {
      const VertexSite& site = side->sites[i];
      const std::array<std::uint32_t, 3>& corners = triangles[site.triangle];
      for (std::size_t c = 0; c < 3; ++c) {
        const float weight = site.area * site.weights[static_cast<Eigen::Index>(c)];
        lamps[v] += weight * side->light[corners[c]].lamps.light;
        surfaces[v] += weight * side->light[corners[c]].surfaces.light;
      }
      area += site.area;
    }
    if (!(area > 0.0f)) {
      lamps[v] = side->light[v].lamps.light;
      surfaces[v] = side->light[v].surfaces.light;
    } else {
      lamps[v] /= area;
      surfaces[v] /= area;
    }
  }
  for (std::size_t v = 0; v < count; ++v) {
    PointLight& light = side->light[v];
    light.lamps.light = (2.0f * light.lamps.light - lamps[v]).cwiseMax(0.0f);
    light.surfaces.light = (2.0f * light.surfaces.light - surfaces[v]).cwiseMax(0.0f);
  }
}

}  // namespace cyclorama::light_baking
