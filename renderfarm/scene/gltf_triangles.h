// SPDX-License-Identifier: Apache-2.0
/// Triangles from a primitive's indices.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/scene/gltf_accessor.h"
#include "renderfarm/scene/gltf_context.h"

namespace cyclorama::scene {

using GltfTriangles = std::vector<std::array<std::uint32_t, 3>>;

/// Values of glTF's `mode`; 1 to 3 are lines, which have no surface.
enum class GltfTopology : std::uint8_t { kPoints = 0, kTriangles = 4, kStrip = 5, kFan = 6 };

/// Returns the triangles of a primitive. Without `indices`, its vertices are used in order. In strips and fans,
/// triangles that repeat a corner only connect parts and are left out. Errors: kBadData if an index is not below
/// `vertex_count`, a type is wrong, or the budget is exceeded.
Result<GltfTriangles> read_triangles(const std::optional<GltfAccessor>& indices, std::size_t vertex_count,
                                     GltfTopology topology, std::string_view place, GltfContext* context);

/// Checks that all corners are below `vertex_count`. Errors: kBadData if one is not.
Status check_corners(const GltfTriangles& triangles, std::size_t vertex_count, std::string_view place);

/// Selects the vertices that the triangles use and renumbers the corners, for primitives that share one long vertex
/// list. Selects all vertices if there are at least as many corners. Precondition: check_corners().
GltfSelection select_vertices(GltfTriangles* triangles, std::size_t vertex_count);

}  // namespace cyclorama::scene
