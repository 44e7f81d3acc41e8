// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/obj_mesh.h"

#include <algorithm>

#include "renderfarm/scene/mesh_repair.h"

namespace cyclorama::scene {
namespace {

std::uint64_t hash_of(const ObjCorner& corner) {
  // Fibonacci hashing, twice, because consecutive corners have consecutive numbers.
  std::uint64_t hash = corner.position * 0x9E3779B97F4A7C15u;
  hash = (hash ^ (hash >> 29) ^ corner.texcoord) * 0xBF58476D1CE4E5B9u;
  hash = (hash ^ (hash >> 32) ^ corner.normal) * 0x94D049BB133111EBu;
  return hash ^ (hash >> 31);
}

}  // namespace

std::size_t ObjLists::memory_bytes() const {
  return positions.size() * sizeof(positions[0]) + colours.size() * sizeof(colours[0]) +
         texcoords.size() * sizeof(texcoords[0]) + normals.size() * sizeof(normals[0]);
}

std::size_t ObjMesh::memory_bytes() const {
  constexpr std::size_t kMeshVertexBytes = 12 + 12 + 8 + 4;
  return vertices_.size() * (sizeof(ObjCorner) + kMeshVertexBytes) + slots_.size() * sizeof(slots_[0]) +
         triangles_.size() * sizeof(triangles_[0]);
}

void ObjMesh::grow() {
  slots_.assign(std::max<std::size_t>(1024, slots_.size() * 2), 0);
  for (std::uint32_t i = 0; i < vertices_.size(); ++i) {
    std::size_t at = hash_of(vertices_[i]) & (slots_.size() - 1);
    while (slots_[at] != 0) at = (at + 1) & (slots_.size() - 1);
    slots_[at] = i + 1;
  }
}

std::uint32_t ObjMesh::vertex_of(const ObjCorner& corner) {
  if (vertices_.size() * 3 >= slots_.size() * 2) grow();
  std::size_t at = hash_of(corner) & (slots_.size() - 1);
  while (slots_[at] != 0) {
    if (vertices_[slots_[at] - 1] == corner) return slots_[at] - 1;
    at = (at + 1) & (slots_.size() - 1);
  }
  vertices_.push_back(corner);
  slots_[at] = static_cast<std::uint32_t>(vertices_.size());
  return slots_[at] - 1;
}

void ObjMesh::add_triangle(const std::array<ObjCorner, 3>& corners) {
  const std::uint32_t a = vertex_of(corners[0]);
  const std::uint32_t b = vertex_of(corners[1]);
  triangles_.push_back({a, b, vertex_of(corners[2])});
}

Mesh ObjMesh::finish(const ObjLists& lists) && {
  Mesh mesh;
  mesh.material = material_;
  slots_ = {};
  mesh.triangles = std::move(triangles_);
  mesh.triangles.shrink_to_fit();
  const auto has = [&](auto member) {
    return std::any_of(vertices_.begin(), vertices_.end(),
                       [&](const ObjCorner& c) { return c.*member != ObjCorner::kNone; });
  };
  const bool has_texcoords = has(&ObjCorner::texcoord);
  const bool has_normals = has(&ObjCorner::normal);
  mesh.origin = vertices_.empty() ? Eigen::Vector3d::Zero() : origin_near(lists.positions[vertices_[0].position]);
  mesh.positions.reserve(vertices_.size());
  mesh.texcoords[0].reserve(has_texcoords ? vertices_.size() : 0);
  mesh.normals.reserve(has_normals ? vertices_.size() : 0);
  for (const ObjCorner& corner : vertices_) {
    const Eigen::Vector3f p = (lists.positions[corner.position] - mesh.origin).cast<float>();
    mesh.positions.push_back({p.x(), p.y(), p.z()});
    if (has_texcoords) {
      const bool given = corner.texcoord != ObjCorner::kNone;
      mesh.texcoords[0].push_back(given ? lists.texcoords[corner.texcoord] : std::array<float, 2>{});
    }
    if (has_normals) {  // A missing normal is repaired like a zero one.
      const bool given = corner.normal != ObjCorner::kNone;
      mesh.normals.push_back(given ? lists.normals[corner.normal] : std::array<float, 3>{});
    }
    if (!lists.colours.empty()) {
      const auto& rgb = lists.colours[corner.position];
      mesh.colours.push_back({rgb[0], rgb[1], rgb[2], 255});
    }
  }
  if (has_normals) repair_normals(&mesh);
  return mesh;
}

}  // namespace cyclorama::scene
