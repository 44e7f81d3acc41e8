// SPDX-License-Identifier: Apache-2.0
/// Writes a walkable area into a scene.toml that people wrote; nothing else in it changes, including comments.
#pragma once

#include <string>
#include <string_view>

#include "common/base/result.h"
#include "renderfarm/walkable/ground_search.h"

namespace cyclorama::walkable {

/// Format the key walkable_m and the [[visitor.hole]] tables of scene.toml; the latter end with a blank line.
[[nodiscard]] std::string walkable_key(const WalkableGround& ground);
[[nodiscard]] std::string hole_tables(const WalkableGround& ground);

/// Returns `text` with the area in [visitor], replacing an existing one, and with [start] eye_m, which an area
/// requires, if that was missing. `text` must be accepted by parse_scene_package(), and so should be the result; `name`
/// identifies the file in errors. Errors: kBadData if its notation cannot be edited, such as visitor = {...}; the
/// message states the remedy.
Result<std::string> with_walkable(std::string_view text, const std::string& name, const WalkableGround& ground,
                                  const Eigen::Vector3d& start_eye);

}  // namespace cyclorama::walkable
