// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
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

/// Memory of each triangle against time for each ray; pictures are the same to the last bit.
///   kFast     shading data of each triangle in a cache line of its own, and Embree's own copy of the vertices
///   kMedium   without the former
///   kCompact  without both
/// `./bench.sh scene-memory` measures them.
enum class MemoryMode : std::uint8_t { kFast, kMedium, kCompact };
inline constexpr std::array kMemoryModes = {MemoryMode::kFast, MemoryMode::kMedium, MemoryMode::kCompact};
[[nodiscard]] std::string_view name_of(MemoryMode mode);

/// Memory that rendering needs besides the loaded scene.
struct RenderNeed {
  std::size_t triangles = 0;
  std::size_t instances = 0;
  std::size_t mip_bytes = 0;  ///< Size of the textures' smaller levels.
  std::size_t splats = 0;
};

/// Returns the fastest mode in which rendering fits into memory; only `wanted` is considered if it is not null. Errors:
/// kSystem, with the scene's title, the memory needed and the memory available, if the need exceeds memory_for_bvh().
Result<MemoryMode> choose_memory_mode(std::string_view title, const RenderNeed& need, std::size_t available,
                                      std::optional<MemoryMode> wanted);

/// Formats a size, such as "3.4 GB".
[[nodiscard]] std::string describe_bytes(std::size_t bytes);

}  // namespace cyclorama::render
