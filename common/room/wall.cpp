// SPDX-License-Identifier: Apache-2.0
#include "common/room/wall.h"

namespace cyclorama {
namespace {
constexpr double kSamePlace_m = 1e-4;  // Tolerance for a point hit from two sides, also at grazing angles.
}

std::optional<Point<frame::Room>> hit(const Wall& wall, const RoomRay& ray) {
  return std::visit([&](const auto& w) { return w.hit(ray); }, wall);
}

std::optional<Point<frame::Room>> hit_extended(const Wall& wall, const RoomRay& ray) {
  return std::visit([&](const auto& w) { return w.hit_extended(ray); }, wall);
}

std::vector<WallPatch> patches(const Wall& wall, std::size_t about) {
  return std::visit([&](const auto& w) { return w.patches(about); }, wall);
}

std::vector<Point<frame::Room>> outline(const Wall& wall) {
  return std::visit([](const auto& w) { return w.outline(); }, wall);
}

std::vector<WallEdge> creases(const Wall& wall) {
  return std::visit([](const auto& w) { return w.creases(); }, wall);
}

bool is_lit_from(const Wall& wall, const Point<frame::Room>& point) {
  return std::visit([&](const auto& w) { return w.is_lit_from(point); }, wall);
}

bool is_reached(const Wall& wall, const Point<frame::Room>& point, const Point<frame::Room>& source) {
  if (!std::visit([](const auto& w) { return w.can_self_shadow(); }, wall)) return true;
  const auto first = hit(wall, {source, point.xyz - source.xyz});
  return first && (first->xyz - point.xyz).norm() <= kSamePlace_m;
}

}  // namespace cyclorama
