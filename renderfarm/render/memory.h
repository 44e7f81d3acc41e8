// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/result.h"

namespace cyclorama::render {

/// Returns the number of bytes that can be allocated before the machine swaps, from the text of /proc/meminfo; null if
/// the text does not state it.
[[nodiscard]] std::optional<std::size_t> parse_available_memory(std::string_view meminfo);

/// Returns the number of bytes that this process may still allocate before its control group or one of the parent
/// groups reaches its limit (cgroup v2, memory.max); null without a limit. File pages that the kernel can reclaim count
/// as free. `root` is the root of the file system.
[[nodiscard]] std::optional<std::size_t> cgroup_memory(const std::filesystem::path& root);

/// Returns the number of bytes that this process can allocate: what the machine has left or what the process's control
/// groups have left, whichever is smaller; null if neither is known.
[[nodiscard]] std::optional<std::size_t> available_memory(const std::filesystem::path& root = "/");

/// Returns the number of bytes, of `available`, that a BVH may use; a small reserve is left for the rest of the
/// machine.
[[nodiscard]] std::size_t memory_for_bvh(std::size_t available);

/// Memory that rendering needs besides the loaded scene.
struct RenderNeed {
  std::size_t triangles = 0;
  std::size_t instances = 0;
  std::size_t mip_bytes = 0;  ///< Size of the textures' smaller levels.
  std::size_t splats = 0;
};

/// Checks that rendering fits into memory. Errors: kSystem, with the scene's title, the memory needed and the memory
/// available, if the need exceeds memory_for_bvh().
Status check_render_memory(std::string_view title, const RenderNeed& need, std::size_t available);

/// Formats a size, such as "3.4 GB".
[[nodiscard]] std::string describe_bytes(std::size_t bytes);

}  // namespace cyclorama::render
