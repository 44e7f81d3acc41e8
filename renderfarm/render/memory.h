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

/// kSystem, with the need and what is there, if building the BVH would take more than memory_for_bvh().
Status check_bvh_memory(std::size_t triangles, std::size_t instances, std::size_t available);

/// "3.4 GB"
[[nodiscard]] std::string describe_bytes(std::size_t bytes);

}  // namespace cyclorama
