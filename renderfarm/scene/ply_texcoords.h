// SPDX-License-Identifier: Apache-2.0
/// Texture coordinates for each corner of each face of a PLY file, as MeshLab, Metashape and RealityCapture write them.
/// A vertex may then have several texture coordinates and must be stored several times.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// Texture coordinates of one triangle's corners; v increases upwards from the last row.
using PlyCorners = std::array<std::array<float, 2>, 3>;

/// Texture coordinates of a mesh, with one entry for each triangle in order. Thread-bound.
class PlyTexcoords {
 public:
  /// Memory of one triangle in the worst case, in which no vertex is shared: the entry and three vertices with all
  /// attributes.
  static constexpr std::size_t kBytesPerTriangle = 28 + 3 * 44;

  void add(const PlyCorners& corners, std::uint32_t texture) { entries_.push_back({corners, texture}); }
  [[nodiscard]] std::size_t size() const { return entries_.size(); }

  /// Splits a mesh into one mesh for each texture, in the order of the textures' numbers. Each gets texture
  /// coordinates, and the number of the texture as its material. Triangles with a corner that `is_unusable` marks
  /// (empty if there are none) are left out. Precondition: size() is the number of triangles.
  [[nodiscard]] std::vector<Mesh> split(const Mesh& mesh, const std::vector<bool>& is_unusable) const;

 private:
  struct Entry {
    PlyCorners corners;
    std::uint32_t texture;
  };
  [[nodiscard]] Mesh part_of(const Mesh& mesh, std::span<const std::uint32_t> triangles) const;

  std::vector<Entry> entries_;
};

}  // namespace cyclorama::scene
