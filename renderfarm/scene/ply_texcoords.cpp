// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/ply_texcoords.h"

#include <map>
#include <utility>

namespace cyclorama::scene {
namespace {

constexpr std::uint32_t kNone = 0xffff'ffff;

/// Linked lists of the copies of each old vertex: a vertex at a seam has one copy for each of its texture coordinates.
struct Copies {
  explicit Copies(std::size_t vertices) : first(vertices, kNone) {}
  std::vector<std::uint32_t> first;  ///< For each old vertex, the number of its first copy.
  std::vector<std::uint32_t> next;   ///< For each copy, the next copy of the same vertex.
};

void copy_vertex(const Mesh& from, std::uint32_t vertex, Mesh* to) {
  to->positions.push_back(from.positions[vertex]);
  if (!from.normals.empty()) to->normals.push_back(from.normals[vertex]);
  if (!from.colours.empty()) to->colours.push_back(from.colours[vertex]);
}

/// Returns the copy of `vertex` that has these texture coordinates, and makes it if there is none.
std::uint32_t copy_with(const Mesh& from, std::uint32_t vertex, const std::array<float, 2>& texcoord, Copies* copies,
                        Mesh* to) {
  for (std::uint32_t copy = copies->first[vertex]; copy != kNone; copy = copies->next[copy]) {
    if (to->texcoords[0][copy] == texcoord) return copy;
  }
  const auto copy = static_cast<std::uint32_t>(to->positions.size());
  copy_vertex(from, vertex, to);
  to->texcoords[0].push_back(texcoord);
  copies->next.push_back(std::exchange(copies->first[vertex], copy));
  return copy;
}

}  // namespace

Mesh PlyTexcoords::part_of(const Mesh& mesh, std::span<const std::uint32_t> triangles) const {
  Mesh part;
  part.name = mesh.name;
  part.origin = mesh.origin;
  part.triangles.reserve(triangles.size());
  Copies copies(mesh.positions.size());
  for (const std::uint32_t triangle : triangles) {
    std::array<std::uint32_t, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::array<float, 2>& uv = entries_[triangle].corners[k];
      corners[k] = copy_with(mesh, mesh.triangles[triangle][k], {uv[0], 1.0f - uv[1]}, &copies, &part);
    }
    part.triangles.push_back(corners);
  }
  return part;
}

std::vector<Mesh> PlyTexcoords::split(const Mesh& mesh, const std::vector<bool>& is_unusable) const {
  std::map<std::uint32_t, std::vector<std::uint32_t>> triangles_of;
  for (std::uint32_t i = 0; i < entries_.size(); ++i) {
    const std::array<std::uint32_t, 3>& t = mesh.triangles[i];
    if (!is_unusable.empty() && (is_unusable[t[0]] || is_unusable[t[1]] || is_unusable[t[2]])) continue;
    triangles_of[entries_[i].texture].push_back(i);
  }
  std::vector<Mesh> parts;
  for (const auto& [texture, triangles] : triangles_of) {
    parts.push_back(part_of(mesh, triangles));
    parts.back().material = static_cast<int>(texture);
  }
  return parts;
}

}  // namespace cyclorama::scene
