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

/// A free-form wall of triangles, whose corners run counter-clockwise as seen from the lit side. Past its rim it goes
/// on in the plane of the rim's nearest triangle. Copies share the triangles. Members as wall_parts.h says; a ray
/// costs about a microsecond for 10 000 triangles, and one past the rim as much as the rim has edges.
class MeshWall {
 public:
  /// An OBJ file's text, in metres of the Room frame. Faces of three corners or more; texture coordinates and normals
  /// may be there and must be whole, but the sweet spot decides what is seen where. kBadData "line 7: ...": anything
  /// that is no number, not finite or farther away than 100 m, a face without area or whose corners are missing or run
  /// against its neighbour's, no face at all, or more than 2 million triangles.
  static Result<MeshWall> read(std::string_view obj_text);

  [[nodiscard]] std::optional<Point<frame::Room>> hit(const RoomRay& ray) const;
  [[nodiscard]] std::optional<Point<frame::Room>> hit_extended(const RoomRay& ray) const;
  /// One per triangle, and large triangles divided.
  [[nodiscard]] std::vector<WallPatch> patches(std::size_t about) const;
  [[nodiscard]] std::vector<Point<frame::Room>> outline() const;
  /// Edges between triangles that meet at more than ten degrees.
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
