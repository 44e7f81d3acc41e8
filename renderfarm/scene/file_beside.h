// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace cyclorama::scene {

/// Returns the file that a geometry file in `folder` names: always inside of it, since a scene reads only what was
/// delivered with it. Of a name that leads out, such as another computer's path, the last part is looked for.
[[nodiscard]] std::filesystem::path file_beside(const std::filesystem::path& folder, std::string name);

}  // namespace cyclorama::scene
