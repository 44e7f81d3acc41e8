// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "renderfarm/render/vectors.h"
#include "renderfarm/scene/model.h"

namespace cyclorama::render {

/// All data of a triangle that matte surfaces need, in one cache line. Scattered rays hit triangles all over the scene;
/// without stored records, ten memory accesses for each hit take a quarter of the render time.
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

/// Borrows the arrays of a mesh's vertices. A pointer is null where the mesh has no such array.
struct VertexArrays {
  const std::array<float, 3>* positions = nullptr;
  const std::array<float, 3>* normals = nullptr;
  const std::array<std::uint8_t, 4>* colours = nullptr;
};

/// Returns the part of a unit normal as TriangleRecord holds it.
[[nodiscard]] inline std::int16_t packed_normal(float part) {
  const float scaled = std::clamp(part, -1.0f, 1.0f) * 32767.0f;
  return static_cast<std::int16_t>(scaled + std::copysign(0.5f, scaled));
}

/// Fills a record, with zeros for arrays that the mesh lacks.
inline void read_triangle(const VertexArrays& vertices, const std::array<std::uint32_t, 3>& triangle,
                          TriangleRecord* ret_record) {
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint32_t vertex = triangle[i];
    ret_record->corners[i] = vertices.positions[vertex];
    ret_record->normals[i] = {};
    ret_record->colours[i] = {};
    if (vertices.normals != nullptr) {
      const std::array<float, 3>& n = vertices.normals[vertex];
      ret_record->normals[i] = {packed_normal(n[0]), packed_normal(n[1]), packed_normal(n[2])};
    }
    if (vertices.colours != nullptr) std::copy_n(vertices.colours[vertex].begin(), 3, ret_record->colours[i].begin());
  }
}

/// Returns one record per triangle. Uses the threads of the TBB arena in which it is called.
[[nodiscard]] std::vector<TriangleRecord> make_triangle_records(const scene::Mesh& mesh);

}  // namespace cyclorama::render
