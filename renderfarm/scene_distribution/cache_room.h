// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>

#include "common/base/result.h"

namespace cyclorama {

/// What may not leave a scene cache while room is made in it.
struct CacheNeeds {
  std::set<std::string> sha256{};  ///< Files of the scene that is wanted, and their parts.
  std::string digest{};            ///< Its folder.
  std::uint64_t bytes = 0;         ///< To come.
};

/// Drops, until `needs` fits: files that belong to no scene, the oldest first; then scenes that nobody holds, the one
/// that was not wanted for longest first. `limit_bytes` of files, 0: only the disk's. Whoever calls holds the cache's
/// lock. kSystem  it cannot fit, with a remedy.
Status make_room(const std::filesystem::path& cache, std::uint64_t limit_bytes, const CacheNeeds& needs);

/// Removes a folder's name before its content, so that no scene is ever half there.
void drop_folder(const std::filesystem::path& folder);

}  // namespace cyclorama
