// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "common/base/check.h"
#include "common/room/mesh_wall.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  const auto wall = MeshWall::read(std::string_view(reinterpret_cast<const char*>(data), size));
  if (!wall) {
    CHECK(!wall.error().message().empty());
    return 0;
  }
  CHECK(wall->triangle_count() > 0);
  const Point<frame::Room> eye{Eigen::Vector3d(0.1, 1.6, 0.2)};
  for (const WallPatch& patch : wall->patches(16)) {
    CHECK(patch.middle.xyz.allFinite() && std::abs(patch.normal.norm() - 1.0) < 1e-6 && patch.area_m2 > 0.0);
    const RoomRay ray{eye, patch.middle.xyz - eye.xyz};
    const auto endless = wall->hit_extended(ray);
    CHECK(!endless || endless->xyz.allFinite());
  }
  for (const WallEdge& edge : wall->creases()) CHECK(edge.from.xyz.allFinite() && edge.to.xyz.allFinite());
  static_cast<void>(wall->is_lit_from(eye));
  return 0;
}
