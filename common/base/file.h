// SPDX-License-Identifier: Apache-2.0
/// Reads and writes whole files, with limits, and with errors that name the file.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "common/base/unique_fd.h"

namespace cyclorama {

/// Reads a regular file of at most `limit_bytes`. Errors: kNotFound if there is no such file; kBadData if it is larger
/// than the limit or not a regular file; else kSystem with errno.
Result<std::vector<std::byte>> read_file(const std::filesystem::path& path, std::size_t limit_bytes);
Result<std::string> read_text_file(const std::filesystem::path& path, std::size_t limit_bytes);

/// Writes a temporary file next to the target and renames it, so that a reader always gets either the old or the new
/// file, complete. Does not create folders.
Status write_file_atomically(const std::filesystem::path& path, std::span<const std::byte> bytes);
Status write_file_atomically(const std::filesystem::path& path, std::string_view text);

/// A whole file, mapped read-only, for geometry: the kernel may drop its pages. Move-only; thread-safe to read. If
/// another process truncates the file while it is mapped, SIGBUS is raised; scenes are therefore installed by rename
/// and never edited in place.
class MappedFile {
 public:
  /// Maps a file; an empty file maps to no bytes. Errors: those of read_file().
  static Result<MappedFile> open(const std::filesystem::path& path);
  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&& other) noexcept;
  ~MappedFile();
  [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_; }

 private:
  explicit MappedFile(std::span<const std::byte> bytes) : bytes_(bytes) {}
  std::span<const std::byte> bytes_;
};

}  // namespace cyclorama
