// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/result.h"

namespace cyclorama {

/// Bytes that can still be taken before the machine swaps, from the text of /proc/meminfo. Nothing if it does not say.
[[nodiscard]] std::optional<std::size_t> parse_available_memory(std::string_view meminfo);

/// The same of this machine; nothing where /proc is absent.
[[nodiscard]] std::optional<std::size_t> available_memory();

/// What a BVH may take of `available` bytes; the rest of the machine keeps a little.
[[nodiscard]] std::size_t memory_for_bvh(std::size_t available);

/// What rendering takes besides the loaded scene.
struct RenderNeed {
  std::size_t triangles = 0;
  std::size_t instances = 0;
  std::size_t mip_bytes = 0;  ///< Of the textures' smaller levels.
};

/// kSystem, with the scene's title, its need and what is there, if that is more than memory_for_bvh().
Status check_render_memory(std::string_view title, const RenderNeed& need, std::size_t available);

/// "3.4 GB"
[[nodiscard]] std::string describe_bytes(std::size_t bytes);

}  // namespace cyclorama
