// SPDX-License-Identifier: Apache-2.0
/// From a primitive's indices to triangles.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/scene/gltf_accessor.h"
#include "renderfarm/scene/gltf_context.h"

namespace cyclorama {

using GltfTriangles = std::vector<std::array<std::uint32_t, 3>>;

/// glTF's `mode`; points and lines, which have no surface, are 0 to 3.
enum class GltfTopology : std::uint8_t { kTriangles = 4, kStrip = 5, kFan = 6 };

/// Without `indices` the vertices follow one another. Triangles of strips and fans that repeat a corner, which only
/// stitch parts together, are left out. kBadData  an index outside `vertex_count`, wrong types, or over the budget.
Result<GltfTriangles> read_triangles(const std::optional<GltfAccessor>& indices, std::size_t vertex_count,
                                     GltfTopology topology, std::string_view place, GltfContext* context);

/// kBadData  a corner outside `vertex_count`.
Status check_corners(const GltfTriangles& triangles, std::size_t vertex_count, std::string_view place);

/// Where many primitives share one long list of vertices, each keeps only its own: renumbers the corners when the
/// triangles cannot need all vertices. Precondition: check_corners().
GltfSelection select_vertices(GltfTriangles* triangles, std::size_t vertex_count);

}  // namespace cyclorama
