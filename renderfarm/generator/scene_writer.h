// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "renderfarm/generator/grotto.h"

namespace cyclorama::generator {

/// Start of every grotto's scene.toml, which identifies a folder that may be replaced.
inline constexpr const char* kSceneMark = "# Made by cyclorama-grotto";

/// Returns the scene.toml of the package. `seed` is stated in it for information only.
[[nodiscard]] std::string scene_toml(const Grotto& grotto, std::uint32_t seed);

}  // namespace cyclorama::generator
