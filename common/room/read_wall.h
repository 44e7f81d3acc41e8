// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

#include "common/config/config.h"
#include "common/room/wall.h"

namespace cyclorama {

/// Reads the [wall] table of an installation.toml, for a wall of any shape; mistakes are recorded in the table. A
/// mesh's file must be in `folder`. Empty if the mistakes leave no wall.
std::optional<Wall> read_wall(ConfigTable table, const std::filesystem::path& folder);

}  // namespace cyclorama
