// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "common/base/result.h"
#include "renderfarm/scene_distribution/file_stamp.h"

namespace cyclorama::scene_distribution {

/// Digests of files that were read earlier, so that a restarted coordinator need not read all scenes again. A file
/// counts as unchanged while its stamp is unchanged. A file that changed just before it was read is not recorded.
/// Thread-bound.
class DigestMemory {
 public:
  /// Reads the digests kept in `file`. With an empty path, nothing is kept across restarts. Unreadable content is
  /// discarded.
  explicit DigestMemory(std::filesystem::path file);

  [[nodiscard]] std::optional<std::string> find(const std::filesystem::path& path, const FileStamp& stamp) const;
  void keep(const std::filesystem::path& path, const HashedFile& hashed);
  /// Writes the file, completely or not at all, if there are new digests.
  Status save();

 private:
  const std::filesystem::path file_;
  std::map<std::string, HashedFile> known_;  ///< Keyed by path.
  bool changed_ = false;
};

}  // namespace cyclorama::scene_distribution
