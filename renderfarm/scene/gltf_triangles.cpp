// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_triangles.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <span>

namespace cyclorama::scene {
namespace {

bool repeats_a_corner(const std::array<std::uint32_t, 3>& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

std::span<std::uint32_t> corners_of(GltfTriangles* triangles) {
  return triangles->empty() ? std::span<std::uint32_t>() : std::span(triangles->front().data(), triangles->size() * 3);
}

Status check_index_format(const GltfAccessor& indices) {
  const std::size_t bytes = component_bytes(indices.component);
  const bool is_unsigned = indices.component == GltfComponent::kU8 || indices.component == GltfComponent::kU16 ||
                           indices.component == GltfComponent::kU32;
  if (!is_unsigned || indices.width != 1) {
    return gltf_damaged(indices.place, "indices are SCALAR and unsigned integers");
  }
  // A stride is refused, because readers disagree about its meaning for indices.
  if (indices.stride != bytes) return gltf_damaged(indices.place, "indices are packed, and these have a byteStride");
  return Done{};
}

/// Connects vertices to the triangles of a strip or fan. Source: glTF 2.0, section 3.7.2.1.
GltfTriangles connect(const std::vector<std::uint32_t>& order, GltfTopology topology) {
  GltfTriangles triangles;
  triangles.reserve(order.size());
  for (std::size_t i = 0; i + 2 < order.size(); ++i) {
    const std::size_t odd = i % 2;
    const std::array<std::uint32_t, 3> triangle = topology == GltfTopology::kStrip
                                                      ? std::array{order[i], order[i + 1 + odd], order[i + 2 - odd]}
                                                      : std::array{order[i + 1], order[i + 2], order[0]};
    if (!repeats_a_corner(triangle)) triangles.push_back(triangle);
  }
  return triangles;
}

void read_order(const std::optional<GltfAccessor>& indices, std::span<std::uint32_t> order) {
  if (indices) {
    read_indices(*indices, order);
  } else {
    std::iota(order.begin(), order.end(), 0U);
  }
}

}  // namespace

Result<GltfTriangles> read_triangles(const std::optional<GltfAccessor>& indices, std::size_t vertex_count,
                                     GltfTopology topology, std::string_view place, GltfContext* context) {
  if (indices) TRY(check_index_format(*indices));
  const std::size_t count = indices ? indices->count : vertex_count;
  GltfTriangles triangles;
  if (topology == GltfTopology::kTriangles) {
    if (count % 3 != 0) context->notes.add("the last one or two vertices make no triangle: ignored", place);
    TRY(context->budget.take(place, count / 3, sizeof triangles[0]));
    triangles.resize(count / 3);
    read_order(indices, corners_of(&triangles));
  } else {
    TRY(context->budget.take(place, count, sizeof triangles[0] + sizeof(std::uint32_t)));
    std::vector<std::uint32_t> order(count);
    read_order(indices, order);
    triangles = connect(order, topology);
    context->budget.give_back(count, sizeof(std::uint32_t));
  }
  TRY(check_corners(triangles, vertex_count, indices ? std::string_view(indices->place) : place));
  return triangles;
}

Status check_corners(const GltfTriangles& triangles, std::size_t vertex_count, std::string_view place) {
  std::uint32_t largest = 0;
  for (const std::array<std::uint32_t, 3>& t : triangles) largest = std::max({largest, t[0], t[1], t[2]});
  if (!triangles.empty() && largest >= vertex_count) {
    return gltf_damaged(place, fmt::format("index {} of {} vertices", largest, vertex_count));
  }
  return Done{};
}

GltfSelection select_vertices(GltfTriangles* triangles, std::size_t vertex_count) {
  const std::span<std::uint32_t> corners = corners_of(triangles);
  if (corners.empty() || corners.size() >= vertex_count) return GltfSelection::all(vertex_count);
  std::vector<std::uint32_t> used(corners.begin(), corners.end());
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  for (std::uint32_t& corner : corners) {
    corner = static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), corner) - used.begin());
  }
  return GltfSelection::some(std::move(used));
}

}  // namespace cyclorama::scene
