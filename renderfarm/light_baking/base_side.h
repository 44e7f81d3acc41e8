// SPDX-License-Identifier: Apache-2.0
/// The base samples of one side of a placement, while light is computed.
#pragma once

#include <cstdint>
#include <vector>

#include "renderfarm/light_baking/bake_settings.h"
#include "renderfarm/light_baking/triangle_grids.h"
#include "renderfarm/light_baking/visible_triangles.h"

namespace cyclorama::light_baking {

/// Visibility of a sample to visitors. kBeside: the sample is a few edges away from a triangle that they see.
enum class Seen : std::uint8_t { kNo, kBeside, kYes };

/// A point in a triangle where the light of one of the triangle's vertices is taken; see vertex_sites.h.
struct VertexSite {
  std::uint32_t triangle = 0;
  render::Vec3 weights = render::Vec3::Zero();
  float area = 0.0f;  ///< Weight of the site.
};

struct BaseSide {
  std::size_t placement = 0;
  bool back = false;
  bool per_triangle = false;
  std::vector<LightPoint> points;
  std::vector<VertexSite> sites{};  ///< Sites in the order of their vertices.
  /// Index of the first site of each vertex, then the number of sites; empty for samples per triangle.
  std::vector<std::uint32_t> site_begin{};
  std::vector<PointLight> light;
  std::vector<Seen> seen;
  std::vector<std::uint32_t> order;     ///< Existing samples, along a curve on which neighbours are close.
  std::vector<SeenTriangle> triangles;  ///< Seen triangles, along the same curve.
  /// Range of the luminance of the lamps' light over each vertex and its neighbours; empty for samples per triangle.
  std::vector<float> lamp_ranges;
  std::vector<std::uint8_t> blocked;  ///< 1 for triangles between whose corners light must not be interpolated.
  /// Triangles between whose corners bounces must not interpolate light, and trace paths instead: those that are large
  /// to visitors, and those on which light of lamps varies otherwise than between the corners.
  std::vector<std::uint32_t> large;
  std::vector<std::uint8_t> misread;  ///< 1 for the latter ones.
};

/// Returns the sides that visitors see, and for bounced rays also the front of each surface of which they see no side.
[[nodiscard]] std::vector<BaseSide> base_sides(const render::TraceScene& scene, const VisibleTriangles& visible,
                                               std::uint64_t seed);

/// Computes lamp_ranges from the lamps' light of the samples that visitors see.
void find_lamp_ranges(const render::SurfaceMesh& mesh, BaseSide* side);

/// Returns the position of a point along a Z-order curve in `box`, as a key for sorting.
[[nodiscard]] std::uint32_t curve_key(const Eigen::AlignedBox3f& box, const render::Vec3& point);

}  // namespace cyclorama::light_baking
