// SPDX-License-Identifier: Apache-2.0
/// Converts OBJ's corners, each with its own position, texture coordinate and normal, to vertices of indexed meshes.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// Indices, from 0, of a face's corner in the lists of an OBJ file.
struct ObjCorner {
  static constexpr std::uint32_t kNone = 0xffffffff;
  std::uint32_t position = 0;
  std::uint32_t texcoord = kNone;
  std::uint32_t normal = kNone;
  friend bool operator==(const ObjCorner&, const ObjCorner&) = default;
};

/// The lists to which the faces of an OBJ file refer.
struct ObjLists {
  std::vector<Eigen::Vector3d> positions;            ///< In double; ObjMesh::finish() makes them relative to an origin.
  std::vector<std::array<std::uint8_t, 3>> colours;  ///< Either empty or one per position.
  std::vector<std::array<float, 2>> texcoords;       ///< v increases downwards.
  std::vector<std::array<float, 3>> normals;

  [[nodiscard]] std::size_t memory_bytes() const;
};

/// A mesh that grows face by face; equal corners become one vertex. Thread-bound.
class ObjMesh {
 public:
  explicit ObjMesh(int material) : material_(material) {}

  /// Adds a triangle. Precondition: all indices of its corners are inside the lists that finish() receives.
  void add_triangle(const std::array<ObjCorner, 3>& corners);
  [[nodiscard]] bool empty() const { return triangles_.empty(); }
  /// Returns the memory of this object and of the Mesh that finish() will return.
  [[nodiscard]] std::size_t memory_bytes() const;
  [[nodiscard]] Mesh finish(const ObjLists& lists) &&;

 private:
  std::uint32_t vertex_of(const ObjCorner& corner);
  void grow();

  int material_;
  std::vector<ObjCorner> vertices_;
  /// Hash table with open addressing, whose size is a power of two and which is at most two thirds full. An entry is
  /// vertex + 1, or 0 if it is free.
  std::vector<std::uint32_t> slots_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
};

}  // namespace cyclorama::scene
