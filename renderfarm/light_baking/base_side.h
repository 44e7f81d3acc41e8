// SPDX-License-Identifier: Apache-2.0
/// The base samples of one side of a placement, while their light is computed.
#pragma once

#include <cstdint>
#include <vector>

#include "renderfarm/light_baking/bake_settings.h"
#include "renderfarm/light_baking/triangle_grids.h"
#include "renderfarm/light_baking/visible_triangles.h"

namespace cyclorama::light_baking {

/// Visibility of a sample's surface to visitors.
enum class Seen : std::uint8_t { kNo, kBeside, kYes };  ///< kBeside: a few steps from what they see.

/// A place in a triangle where the light of one of its vertices is taken; see vertex_sites.h.
struct VertexSite {
  std::uint32_t triangle = 0;
  render::Vec3 weights = render::Vec3::Zero();
  float area = 0.0f;  ///< Its weight.
};

struct BaseSide {
  std::size_t placement = 0;
  bool back = false;
  bool per_triangle = false;
  std::vector<LightPoint> points;
  std::vector<VertexSite> sites{};          ///< Those of each vertex together.
  std::vector<std::uint32_t> site_begin{};  ///< First site of each vertex, and the end; empty for samples per triangle.
  std::vector<PointLight> light;
  std::vector<Seen> seen;
  std::vector<std::uint32_t> order;     ///< Samples that exist, along a curve on which neighbours follow one another.
  std::vector<SeenTriangle> triangles;  ///< Along the same curve.
  /// Range of the luminance of lamps' light over each vertex and its neighbours; empty for samples per triangle.
  std::vector<float> lamp_ranges;
  std::vector<std::uint8_t> blocked;  ///< 1 for triangles between whose corners light must not be interpolated.
  /// Triangles between whose corners bounces must not interpolate light, and trace paths instead: those that are large
  /// to visitors, and those on which light of lamps varies otherwise than between the corners.
  std::vector<std::uint32_t> large;
  std::vector<std::uint8_t> misread;  ///< 1 for the latter ones.
};

/// Returns the sides that visitors see. Rays that only bounce need the front of a surface, so that is there as well,
/// unless visitors see nothing but the back.
[[nodiscard]] std::vector<BaseSide> base_sides(const render::TraceScene& scene, const VisibleTriangles& visible,
                                               std::uint64_t seed);

/// Sets lamp_ranges, once the lamps' light is known. Only samples that visitors see count.
void find_lamp_ranges(const render::SurfaceMesh& mesh, BaseSide* side);

/// Returns a key by which points of `box` are ordered along a Z-order curve.
[[nodiscard]] std::uint32_t curve_key(const Eigen::AlignedBox3f& box, const render::Vec3& point);

}  // namespace cyclorama::light_baking
