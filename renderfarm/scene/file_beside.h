// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace cyclorama::scene {

/// Returns the path of a file to which a geometry file in `folder` refers. The result is always inside `folder`,
/// because a scene reads only what was delivered with it: if `name` leads outside, as an absolute path of another
/// computer does, only its last part is used.
[[nodiscard]] std::filesystem::path file_beside(const std::filesystem::path& folder, std::string name);

}  // namespace cyclorama::scene
