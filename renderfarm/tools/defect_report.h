// SPDX-License-Identifier: Apache-2.0
/// What `cyclorama-render inspect` reports of a scene's defects.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/base/result.h"
#include "renderfarm/render/renderer.h"
#include "renderfarm/scene/defects.h"

namespace cyclorama::tools {

/// Prints how many there are of each kind and where the largest one is.
void print_defects(const scene::Defects& defects);

/// Draws the largest defects of each kind, a ring around each, into PNG files in `folder`, which is made; prints the
/// files' names. Errors: kSystem if a file cannot be written.
Status draw_defects(const render::Renderer& renderer, const scene::Defects& defects,
                    const std::filesystem::path& folder);

/// Returns the text of a scene.toml with `repair = true`. Precondition: parse_scene_package() accepts `text`.
[[nodiscard]] std::string with_repair(std::string_view text);

/// Writes `repair = true` into the scene.toml of a scene package. Errors: kInvalidArgument if `scene` is a geometry
/// file, which has none; kSystem if the file cannot be written.
Status save_repair(const std::filesystem::path& scene);

}  // namespace cyclorama::tools
