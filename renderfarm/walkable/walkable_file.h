// SPDX-License-Identifier: Apache-2.0
/// Writes a walkable area into an existing scene.toml; the rest of the file, including comments, does not change.
#pragma once

#include <string>
#include <string_view>

#include "common/base/result.h"
#include "renderfarm/walkable/ground_search.h"

namespace cyclorama::walkable {

/// walkable_key() and hole_tables() return the key walkable_m and the [[visitor.hole]] tables of a scene.toml; each
/// table ends with a blank line.
[[nodiscard]] std::string walkable_key(const WalkableGround& ground);
[[nodiscard]] std::string hole_tables(const WalkableGround& ground);

/// Returns `text` with the area in [visitor], replacing an existing one, and with [start] eye_m, which an area
/// requires, if that was missing. Precondition: parse_scene_package() accepts `text`. Callers should check that it
/// accepts the result too. `name` identifies the file in errors. Errors: kBadData if the notation of `text` cannot be
/// edited, such as visitor = {...}; the message states the remedy.
Result<std::string> with_walkable(std::string_view text, const std::string& name, const WalkableGround& ground,
                                  const Eigen::Vector3d& start_eye);

}  // namespace cyclorama::walkable
