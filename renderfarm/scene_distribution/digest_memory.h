// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "common/base/result.h"
#include "renderfarm/scene_distribution/file_stamp.h"

namespace cyclorama {

/// The digests of files that were read before, so that a head that starts again need not read all scenes anew. A file
/// is believed to be unchanged while its stamp is; one that was changed just before it was read is not remembered.
/// Thread-bound.
class DigestMemory {
 public:
  /// Without a file it remembers nothing over restarts. What cannot be read of it is forgotten.
  explicit DigestMemory(std::filesystem::path file);

  [[nodiscard]] std::optional<std::string> find(const std::filesystem::path& path, const FileStamp& stamp) const;
  void keep(const std::filesystem::path& path, const HashedFile& hashed);
  /// Writes the file, whole or not at all, if there is something new.
  Status save();

 private:
  const std::filesystem::path file_;
  std::map<std::string, HashedFile> known_;  ///< By path.
  bool changed_ = false;
};

}  // namespace cyclorama
