// SPDX-License-Identifier: Apache-2.0
/// A found area, written into a scene.toml that people wrote: nothing else of it changes, comments included.
#pragma once

#include <string>
#include <string_view>

#include "common/base/result.h"
#include "renderfarm/walkable/ground_search.h"

namespace cyclorama {

/// As scene.toml has it: walkable_m and the [[visitor.hole]] tables, which end with a blank line.
[[nodiscard]] std::string walkable_key(const WalkableGround& ground);
[[nodiscard]] std::string hole_tables(const WalkableGround& ground);

/// `text` with the area in [visitor], in place of the one that it had, and with [start] eye_m, which an area needs, if
/// that was missing. `text` is one that parse_scene_package() reads, and so should be what comes of it; `name` stands
/// for the file in errors. kBadData  written in a way that this cannot edit, such as visitor = {...}: the remedy is in
/// the message.
Result<std::string> with_walkable(std::string_view text, const std::string& name, const WalkableGround& ground,
                                  const Eigen::Vector3d& start_eye);

}  // namespace cyclorama
