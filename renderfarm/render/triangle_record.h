// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "renderfarm/render/vectors.h"
#include "renderfarm/scene/model.h"

namespace cyclorama::render {

/// All data of a triangle that matte surfaces need, in one cache line. Scattered rays hit triangles all over the scene;
/// without records, ten memory accesses for each hit take a quarter of the render time.
struct alignas(64) TriangleRecord {
  std::array<std::array<float, 3>, 3> corners;
  /// Per corner, times 32767; they differ from the mesh's normals by at most 2e-5.
  std::array<std::array<std::int16_t, 3>, 3> normals;
  std::array<std::array<std::uint8_t, 3>, 3> colours;  ///< Per corner, sRGB.

  [[nodiscard]] Vec3 corner(std::size_t i) const { return to_vec3(corners[i]); }
  [[nodiscard]] Vec3 normal(std::size_t i) const {
    constexpr float kScale = 1.0f / 32767.0f;
    const std::array<std::int16_t, 3>& n = normals[i];
    return Vec3(n[0], n[1], n[2]) * kScale;
  }
};
static_assert(sizeof(TriangleRecord) == 64);

/// Returns one record per triangle, with zeros for arrays that the mesh lacks. Uses the threads of the TBB arena in
/// which it is called.
[[nodiscard]] std::vector<TriangleRecord> make_triangle_records(const scene::Mesh& mesh);

}  // namespace cyclorama::render
