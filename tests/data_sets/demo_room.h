// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <filesystem>

#include "common/room/installation.h"

namespace cyclorama {

/// Path of the demo's installation in the source tree, which ctest sets.
inline std::filesystem::path demo_installation_path() {
  const char* const source = std::getenv("CYCLORAMA_SOURCE");
  return std::filesystem::path(source != nullptr ? source : ".") / "demo" / "installation.toml";
}
inline Installation demo_room() {
  auto room = read_installation(demo_installation_path());
  CHECK(room.has_value());
  return *std::move(room);
}

/// The same with fewer pixels in each dimension, for speed.
inline Installation demo_room_with_pixels_over(int divisor) {
  Installation room = demo_room();
  for (InstalledProjector& projector : room.projectors) {
    Pinhole& lens = projector.lens;
    lens.width_px /= divisor;
    lens.height_px /= divisor;
    lens.focal_px /= divisor;
    lens.centre_u_px /= divisor;
    lens.centre_v_px /= divisor;
  }
  return room;
}

/// Precondition: the wall is a cylinder, as the demo's is.
inline const CylinderWall& cylinder_of(const Installation& room) { return std::get<CylinderWall>(room.wall); }

}  // namespace cyclorama
