// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>

#include "common/base/result.h"

namespace cyclorama::scene_distribution {

/// The contents of a scene cache that must be kept while room is made.
struct CacheNeeds {
  std::set<std::string> sha256{};  ///< Digests of the files of the requested scene, complete or partial.
  std::string digest{};            ///< Digest of the requested scene, which names its folder.
  std::uint64_t bytes = 0;         ///< Number of bytes still to be fetched.
};

/// Drops content until `needs` fits: first files that belong to no scene, oldest first; then scenes that nobody holds,
/// least recently requested first. `limit_bytes` limits all files; 0: only the disk limits them. The caller must hold
/// the cache's lock. Errors: kSystem, with a remedy, if `needs` cannot fit.
Status make_room(const std::filesystem::path& cache, std::uint64_t limit_bytes, const CacheNeeds& needs);

/// Removes a scene's folder. Renames it before removing its content, so that no scene is ever incomplete.
void drop_folder(const std::filesystem::path& folder);

}  // namespace cyclorama::scene_distribution
