// SPDX-License-Identifier: Apache-2.0
/// The points at which the light of a vertex is taken, which are inside seen triangles around the vertex instead of at
/// it.
///
///        b ______ a        Each triangle has one site for each of its vertices: the centroid of the vertex's share of
///         \  o   /         the triangle, half of the way from the vertex to the middle of the opposite edge. The mean
///          \ ·  /          of all sites, weighted by area, is the mean of the light over the surface. The light at
///           \  /           the vertices themselves differs: vertices are in valleys, where the horizon is higher;
///            c             their normals match those between them only on average; and objects hide some of them.
///
/// Light interpolated between such means is blurred; sharpen() undoes most of the blur. Source: Kavan, Bargteil and
/// Sloan, "Least Squares Vertex Baking", 2011: the means are the right-hand side of their equations, and sharpen() is
/// one step of their solution.
#pragma once

#include <vector>

#include "renderfarm/light_baking/base_side.h"

namespace cyclorama::light_baking {

/// Finds the sites of some of the side's triangles. The site of corner c of triangles[i] is element 3 i + c of the
/// result. A site that is hidden from the seen point of its triangle is moved towards that point until it is visible.
/// Thread-bound like `tracer`.
[[nodiscard]] std::vector<VertexSite> find_sites(const render::TraceScene& scene, const BaseSide& side,
                                                 std::span<const SeenTriangle> triangles, LightTracer& tracer);

/// Assigns its sites to each vertex. `sites` are those of all the side's triangles. A vertex is hidden if all of its
/// sites had to be moved; otherwise, moved sites do not count. Returns the number of hidden vertices.
std::size_t assign_sites(const render::Placement& placement, std::span<const VertexSite> sites, BaseSide* side);

/// Returns the points of a sample with their cumulative weights; a sample without sites has one point.
[[nodiscard]] LightSpot spot_of(const render::Placement& placement, const BaseSide& side, std::uint32_t sample);

/// Increases the differences of light between neighbouring vertices, which averaging over their sites has reduced.
/// Light stays positive.
void sharpen(const render::Placement& placement, BaseSide* side);

}  // namespace cyclorama::light_baking
