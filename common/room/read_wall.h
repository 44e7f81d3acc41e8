// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

#include "common/config/config.h"
#include "common/room/wall.h"

namespace cyclorama {

/// The [wall] of an installation.toml, of any shape; mistakes are recorded with the table. A mesh's file is sought in
/// `folder`. Nothing after a mistake that leaves no wall at all.
std::optional<Wall> read_wall(ConfigTable table, const std::filesystem::path& folder);

}  // namespace cyclorama
