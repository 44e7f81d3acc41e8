// SPDX-License-Identifier: Apache-2.0
/// Whole files in and out, with limits, and errors that name the file.
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

/// Reads a regular file of at most `limit_bytes`.
///
/// kNotFound  no such file.     kBadData  larger than the limit, or not a regular file.     kSystem  errno says why.
Result<std::vector<std::byte>> read_file(const std::filesystem::path& path, std::size_t limit_bytes);
Result<std::string> read_text_file(const std::filesystem::path& path, std::size_t limit_bytes);

/// Writes beside the target and renames, so that a reader sees the old file or the new one, whole. Makes no folders.
Status write_file_atomically(const std::filesystem::path& path, std::span<const std::byte> bytes);
Status write_file_atomically(const std::filesystem::path& path, std::string_view text);

/// A whole file, mapped read-only: for geometry, whose pages the kernel may drop again. Move-only; thread-safe to read.
/// A file that another process truncates while it is mapped raises SIGBUS: scenes are installed by rename, never edited.
class MappedFile {
 public:
  /// Errors as read_file(). An empty file maps to no bytes.
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
