// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>

#include "common/base/result.h"

namespace cyclorama::scene_distribution {

/// Contents of a scene cache that must stay while room is made.
struct CacheNeeds {
  std::set<std::string> sha256{};  ///< Files of the requested scene, and their parts.
  std::string digest{};            ///< The requested scene's folder.
  std::uint64_t bytes = 0;         ///< Still to be fetched.
};

/// Drops content until `needs` fits: files that belong to no scene, oldest first; then scenes that nobody holds, least
/// recently requested first. `limit_bytes` limits all files; 0 leaves only the disk's limit. The caller holds the
/// cache's lock. Errors: kSystem, with a remedy, if it cannot fit.
Status make_room(const std::filesystem::path& cache, std::uint64_t limit_bytes, const CacheNeeds& needs);

/// Renames the folder before removing its content, so that no scene is ever incomplete.
void drop_folder(const std::filesystem::path& folder);

}  // namespace cyclorama::scene_distribution
