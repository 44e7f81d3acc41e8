// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "common/config/config.h"

namespace cyclorama {

/// Returns the path of a file that a key names, in the installation's folder. Empty if the key is absent or names a
/// file elsewhere, which is refused.
inline std::filesystem::path file_beside(ConfigTable* table, const char* key, const std::filesystem::path& folder) {
  const std::filesystem::path file = table->text(key);
  if (!file.empty() && file.filename() == file) return folder / file;
  if (table->has(key)) table->refuse(key, "must be the name of a file beside the installation, not a path");
  return {};
}

}  // namespace cyclorama
