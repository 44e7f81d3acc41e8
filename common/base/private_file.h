// SPDX-License-Identifier: Apache-2.0
/// Writes keys.
#pragma once

#include <filesystem>
#include <string_view>

#include "common/base/result.h"

namespace cyclorama {

/// Writes a whole file that only this user can read, from its first byte on: a temporary file next to the target, which
/// is renamed when it is on the disk. Used by one process at a time. Errors: kSystem.
Status write_private_file(const std::filesystem::path& path, std::string_view text);

}  // namespace cyclorama
