// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <filesystem>

#include "common/room/installation.h"

namespace cyclorama {

/// The demo's installation, in the source tree that ctest names.
inline std::filesystem::path demo_installation_path() {
  const char* const source = std::getenv("CYCLORAMA_SOURCE");
  return std::filesystem::path(source != nullptr ? source : ".") / "demo" / "installation.toml";
}
inline Installation demo_room() {
  auto room = read_installation(demo_installation_path());
  CHECK(room.has_value());
  return *std::move(room);
}

/// Precondition: its wall is one, as the demo's is.
inline const CylinderWall& cylinder_of(const Installation& room) { return std::get<CylinderWall>(room.wall); }

}  // namespace cyclorama
