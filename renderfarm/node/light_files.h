// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "common/base/result.h"

namespace cyclorama::node {

/// Determines where a node stores the light that it computes: in `light/` of its cache, one file per scene, or in the
/// scene's own folder if the node has no cache. Thread-safe.
class LightFiles {
 public:
  /// An empty folder means that the node has no cache.
  explicit LightFiles(std::filesystem::path cache) : cache_(std::move(cache)) {}

  /// Returns the path of the file for the light of the scene at `path`, whether or not the file exists. Empty if the
  /// node has no cache and the scene is not a folder.
  [[nodiscard]] std::filesystem::path file_of(const std::string& path) const;
  /// Prepares that place for a new file: creates the folder, and removes the oldest files beyond a limit, unfinished
  /// light included. Errors: one sentence on why nothing can be written there.
  Result<std::filesystem::path> prepare(const std::string& path) const;
  /// Removes the incomplete files that killed computations left beside `file`. Precondition: the light of `file` is not
  /// being computed.
  static void remove_left_over(const std::filesystem::path& file);

 private:
  const std::filesystem::path cache_;
};

}  // namespace cyclorama::node
