// SPDX-License-Identifier: Apache-2.0
/// A point at which the light of a vertex is taken: inside a seen triangle around it, not at the vertex itself.
///
///        b ______ a        Each triangle has one site for each of its vertices, half of the way to its middle line:
///         \  o   /         the centre of the vertex's share of it. The mean of all sites, by area, is the mean of the
///          \ ·  /          light over the surface, which the vertices themselves do not give: they lie in valleys,
///           \  /           whose horizon is higher, their normals agree with those between them only on average, and
///            c             some are hidden by what stands on the surface.
///
/// Light interpolated between such means is blurred; sharpen() undoes most of that. Source: Kavan, Bargteil and Sloan,
/// "Least Squares Vertex Baking", 2011: the means are the right side of their equations, sharpen() is a step of their
/// solution.
#pragma once

#include <vector>

#include "renderfarm/light_baking/base_side.h"

namespace cyclorama::light_baking {

/// Looks for the sites in some of the side's triangles, which lie at their number times 3 plus the corner's. A site that
/// the seen point of its triangle does not see moves towards it until it does. Thread-bound by `tracer`.
[[nodiscard]] std::vector<VertexSite> find_sites(const render::TraceScene& scene, const BaseSide& side,
                                                 std::span<const SeenTriangle> triangles, LightTracer& tracer);

/// Gives each vertex its sites, from those of all the side's triangles. A site that had to move counts only if all
/// sites of its vertex had to: the vertex is hidden. Returns the number of such vertices.
std::size_t assign_sites(const render::Placement& placement, std::span<const VertexSite> sites, BaseSide* side);

/// Returns the points of a sample, with the weights up to each; one point for a sample that has no sites.
[[nodiscard]] LightSpot spot_of(const render::Placement& placement, const BaseSide& side, std::uint32_t sample);

/// Raises the differences of the light between vertices that come from their sites' distance. Light stays positive.
void sharpen(const render::Placement& placement, BaseSide* side);

}  // namespace cyclorama::light_baking
