// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "common/room/installation.h"

namespace cyclorama {

/// The demo's installation, from the source tree that this test was built from.
inline std::filesystem::path demo_installation_path() {
  return std::filesystem::path(__FILE__).parent_path().parent_path().parent_path() / "demo" / "installation.toml";
}
inline Installation demo_room() {
  auto room = read_installation(demo_installation_path());
  CHECK(room.has_value());
  return *std::move(room);
}

}  // namespace cyclorama
