// SPDX-License-Identifier: Apache-2.0
/// Whole files by their SHA-256, and how to tell that one was not changed since.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "common/base/result.h"
#include "common/base/unique_fd.h"

namespace cyclorama {

/// A file that still has its stamp has its bytes still, unless it was written within the same tick of the file
/// system's clock.
struct FileStamp {
  std::uint64_t inode = 0;
  std::uint64_t bytes = 0;
  std::int64_t modified_ns = 0;
  std::int64_t changed_ns = 0;  ///< Of anything about it, its name included: who copies times cannot set this one.
  bool operator==(const FileStamp&) const = default;
};

/// A regular file, open for reading; links are followed. Errors as read_file() of common/base/file.h.
struct StampedFile {
  UniqueFd fd;
  FileStamp stamp;
};
Result<StampedFile> open_stamped(const std::filesystem::path& path);

struct HashedFile {
  FileStamp stamp;
  std::string sha256;
};
/// Told how many bytes more are done; false: give up.
using GoOn = std::function<bool(std::uint64_t bytes)>;
/// kBusy  it was changed while it was read: try again.   kUnavailable  given up.   Else as open_stamped(). Blocks.
Result<HashedFile> hash_file(const std::filesystem::path& path, const GoOn& go_on);

}  // namespace cyclorama
