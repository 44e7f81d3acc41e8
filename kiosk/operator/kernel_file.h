// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace cyclorama::operations {

/// Returns the first 64 KiB of a file in /proc or /sys, which reports a size other than that of its content; nothing if
/// it cannot be read.
[[nodiscard]] std::optional<std::string> read_kernel_file(const std::filesystem::path& path);

}  // namespace cyclorama::operations
