// SPDX-License-Identifier: Apache-2.0
/// The surface that the picture is projected on, of any kind; wall_parts.h describes these functions. Reentrant.
#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "common/room/cylinder_wall.h"
#include "common/room/dome_wall.h"
#include "common/room/mesh_wall.h"
#include "common/room/planes_wall.h"

namespace cyclorama {

using Wall = std::variant<CylinderWall, PlanesWall, DomeWall, MeshWall>;

[[nodiscard]] std::optional<Point<frame::Room>> hit(const Wall& wall, const RoomRay& ray);
[[nodiscard]] std::optional<Point<frame::Room>> hit_extended(const Wall& wall, const RoomRay& ray);
[[nodiscard]] std::vector<WallPatch> patches(const Wall& wall, std::size_t about);
[[nodiscard]] std::vector<Point<frame::Room>> outline(const Wall& wall);
[[nodiscard]] std::vector<WallEdge> creases(const Wall& wall);
[[nodiscard]] bool is_lit_from(const Wall& wall, const Point<frame::Room>& point);

/// True if light from `source` reaches a point of the wall: no other part of the wall is in between, and the light does
/// not come from behind.
[[nodiscard]] bool is_reached(const Wall& wall, const Point<frame::Room>& point, const Point<frame::Room>& source);

}  // namespace cyclorama
