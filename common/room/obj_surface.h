// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "common/base/result.h"

namespace cyclorama {

/// A surface of triangles, without data that serves only to draw it. Metres.
struct ObjSurface {
  std::vector<Eigen::Vector3d> positions;  ///< Each position is unique.
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Edge between two corners of `triangle`, in that triangle's order. In `other`, the triangle on the edge's other side,
/// it runs the opposite way. At the surface's rim, `other` is absent.
struct ObjEdge {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
  std::size_t triangle = 0;
  std::optional<std::size_t> other;
};

/// Reads an OBJ file's text strictly: refuses faults that a scene's importer would repair. Errors: those of
/// MeshWall::read().
Result<ObjSurface> read_obj_surface(std::string_view text);

/// Returns all edges, each once.
[[nodiscard]] std::vector<ObjEdge> edges_of(const ObjSurface& surface);

}  // namespace cyclorama
