// SPDX-License-Identifier: Apache-2.0
/// A mesh that is built row by row while a PLY file is read; it keeps Model's invariants.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/scene/model.h"
#include "renderfarm/scene/ply_header.h"
#include "renderfarm/scene/ply_texcoords.h"

namespace cyclorama::scene {

/// Meaning of a vertex property.
enum PlyRole : std::size_t { kX, kY, kZ, kNx, kNy, kNz, kU, kV, kRed, kGreen, kBlue, kAlpha, kRoleCount, kNoRole };

/// Destination of each value of a vertex row.
class PlyVertexLayout {
 public:
  explicit PlyVertexLayout(const PlyElement& vertex);
  [[nodiscard]] PlyRole role(std::size_t property) const { return roles_[property]; }
  [[nodiscard]] bool has(PlyRole role) const { return has_[role]; }
  [[nodiscard]] bool has_normal() const { return has_[kNx] && has_[kNy] && has_[kNz]; }
  [[nodiscard]] bool has_texcoord() const { return has_[kU] && has_[kV]; }
  [[nodiscard]] bool has_colour() const { return has_[kRed] && has_[kGreen] && has_[kBlue]; }
  [[nodiscard]] double colour_scale(PlyRole role) const { return colour_scale_[role]; }
  [[nodiscard]] bool is_double() const { return is_double_; }

 private:
  std::vector<PlyRole> roles_;
  std::array<bool, kNoRole + 1> has_{};
  std::array<double, kNoRole + 1> colour_scale_{};
  bool is_double_ = false;
};

/// A row of the element 'face'.
struct PlyFace {
  std::vector<double> corners;    ///< Numbers of vertices.
  std::vector<double> texcoords;  ///< u and v of each corner, or empty.
  double texture = 0.0;           ///< Number of the texture, from 0.
};

/// Thread-bound.
class PlyMesh {
 public:
  /// `limit_bytes` is the maximum memory of the mesh.
  explicit PlyMesh(std::size_t limit_bytes) : limit_bytes_(limit_bytes) {}

  /// Sets the number of vertices; must be called first, because faces may precede vertices in the file. Errors:
  /// kBadData unless there is exactly one element 'vertex' and it has positions, or if the limit is exceeded.
  Status begin(const PlyHeader& header);
  void add_vertex(const PlyVertexLayout& layout, const std::array<double, kNoRole + 1>& row);

  /// Reserves memory for `count` more triangles. Errors: kBadData if the limit is exceeded.
  Status reserve_triangles(std::uint64_t count);
  /// Adds a face as the file states it. Errors: kBadData if a corner is not the number of a vertex, the texture is not
  /// in the header, or the limit is exceeded.
  Status add_polygon(const PlyFace& face);
  /// Adds a strip, or several that are separated by -1. Errors: those of add_polygon().
  Status add_strip(std::span<const double> corners);

  /// Returns the finished model; if the file has no faces, its points become small squares (point_squares.h). If meshes
  /// have texture coordinates, the texture of material n is number n of PlyHeader::texture_files; it is not loaded yet.
  /// Errors: kBadData if nothing is left.
  Result<Model> finish() &&;

 private:
  Result<std::uint32_t> index_of(double corner) const;
  Status add_texcoords(const PlyFace& face);
  Status check_memory(std::uint64_t triangles) const;
  Status show_points(std::vector<std::string>* notes);

  std::size_t limit_bytes_;
  std::size_t bytes_per_vertex_ = 0;
  std::uint64_t vertex_count_ = 0;
  Mesh mesh_;
  bool has_origin_ = false;
  bool has_alpha_ = false;
  bool has_faces_ = false;         ///< The file has faces or strips, whether usable or not.
  std::vector<bool> is_unusable_;  ///< One entry per vertex; empty while all vertices are usable.
  std::size_t texture_count_ = 0;
  PlyTexcoords texcoords_;  ///< Empty unless faces have texture coordinates.
  std::uint64_t polygons_without_area_ = 0;
  std::vector<std::uint32_t> indices_;  // Scratch, reused from row to row.
  std::vector<Eigen::Vector3d> corners_;
  std::vector<std::array<std::uint32_t, 3>> pieces_;
};

}  // namespace cyclorama::scene
