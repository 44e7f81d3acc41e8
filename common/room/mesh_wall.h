// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "common/room/wall_parts.h"

namespace cyclorama {

/// A free-form wall of triangles, whose corners run counter-clockwise as seen from the lit side. Beyond its rim it
/// continues in the plane of the rim's nearest triangle. Copies share the triangles. wall_parts.h describes the common
/// members. With 10 000 triangles, a ray takes about a microsecond; a ray beyond the rim takes time proportional to the
/// number of rim edges.
class MeshWall {
 public:
  /// Reads an OBJ file's text, in metres of the Room frame, with faces of three or more corners. Texture coordinates
  /// and normals must be valid but are not used. Errors: kBadData "line 7: ..." for a number that is invalid, not
  /// finite or beyond 100 m; for a face that has no area, lacks corners or is wound opposite to its neighbour; and for
  /// no face at all or more than 2 million triangles.
  static Result<MeshWall> read(std::string_view obj_text);

  [[nodiscard]] std::optional<Point<frame::Room>> hit(const RoomRay& ray) const;
  [[nodiscard]] std::optional<Point<frame::Room>> hit_extended(const RoomRay& ray) const;
  /// Returns one patch per triangle, or several for a large triangle.
  [[nodiscard]] std::vector<WallPatch> patches(std::size_t about) const;
  [[nodiscard]] std::vector<Point<frame::Room>> outline() const;
  /// Returns the edges between triangles that meet at more than ten degrees.
  [[nodiscard]] std::vector<WallEdge> creases() const;
  [[nodiscard]] bool is_lit_from(const Point<frame::Room>& point) const;
  [[nodiscard]] bool can_self_shadow() const { return true; }

  [[nodiscard]] std::size_t triangle_count() const;

 private:
  struct Surface;
  explicit MeshWall(std::shared_ptr<const Surface> surface) : surface_(std::move(surface)) {}
  std::shared_ptr<const Surface> surface_;
};

}  // namespace cyclorama
