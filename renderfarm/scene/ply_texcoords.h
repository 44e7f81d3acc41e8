// SPDX-License-Identifier: Apache-2.0
/// Texture coordinates that a PLY file gives for each corner of each face, as MeshLab, Metashape and RealityCapture write
/// them: one vertex then has several, and must be stored several times.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// Texture coordinates of one triangle's corners, v counting up from the last row.
using PlyCorners = std::array<std::array<float, 2>, 3>;

/// One entry for each triangle of a mesh, in order. Thread-bound.
class PlyTexcoords {
 public:
  /// Memory of one triangle at its worst, when no vertex is shared: the entry and three vertices with all attributes.
  static constexpr std::size_t kBytesPerTriangle = 28 + 3 * 44;

  void add(const PlyCorners& corners, std::uint32_t texture) { entries_.push_back({corners, texture}); }
  [[nodiscard]] std::size_t size() const { return entries_.size(); }

  /// Splits a mesh into one for each texture, in order of their numbers; each gets texture coordinates and the number as
  /// its material. Triangles whose corners are in `is_unusable` (empty for none) are left out.
  /// Precondition: size() is the number of triangles.
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
