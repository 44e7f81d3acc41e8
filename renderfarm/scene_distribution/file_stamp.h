// SPDX-License-Identifier: Apache-2.0
/// SHA-256 of whole files, and stamps that detect later changes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "common/base/result.h"
#include "common/base/unique_fd.h"

namespace cyclorama::scene_distribution {

/// Identifies a file's state. A file with the same stamp has the same bytes, unless it was written within one tick of
/// the file system's clock.
struct FileStamp {
  std::uint64_t inode = 0;
  std::uint64_t bytes = 0;
  std::int64_t modified_ns = 0;
  std::int64_t changed_ns = 0;  ///< Time of any change, even of the name; copying a file's times cannot set it.
  bool operator==(const FileStamp&) const = default;
};

/// A regular file that is open for reading. Links are followed. Errors of open_stamped(): those of read_file() in
/// common/base/file.h.
struct StampedFile {
  UniqueFd fd;
  FileStamp stamp;
};
Result<StampedFile> open_stamped(const std::filesystem::path& path);

struct HashedFile {
  FileStamp stamp;
  std::string sha256;
};
/// Receives the number of bytes done since the last call. Returns false to give up.
using ContinueCheck = std::function<bool(std::uint64_t bytes)>;
/// Hashes a file. Blocks. Errors: kBusy if the file changed while it was read (try again); kUnavailable if
/// `should_continue` returned false; otherwise those of open_stamped().
Result<HashedFile> hash_file(const std::filesystem::path& path, const ContinueCheck& should_continue);

}  // namespace cyclorama::scene_distribution
