// SPDX-License-Identifier: Apache-2.0
/// Copies an untrusted folder, file by file, into a folder that only this user can change. The copy is checked, not the
/// original.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"

namespace cyclorama::provision {

struct FolderLimits {
  std::size_t max_files = 200;
  std::size_t max_file_bytes = std::size_t{64} << 20;  ///< Limit of one file; measured warps are the largest.
  std::size_t max_bytes = std::size_t{256} << 20;      ///< Limit of all files together.
};

/// Reduces the limits to the available space less 256 MiB for other programs; never below 1 MiB, enough for settings.
[[nodiscard]] FolderLimits within(std::uintmax_t available_bytes, FolderLimits limits);

struct CopiedFile {
  std::string name;  ///< "site.toml", "tls/key.pem".
  std::size_t bytes = 0;
  std::string sha256;  ///< Hexadecimal.
};

struct CopiedFolder {
  std::vector<CopiedFile> files;  ///< Sorted by name.
  /// Files that computers put on USB sticks by themselves: ".Trashes", "desktop.ini".
  std::vector<std::string> left_out;
};

/// True for a name of at most 80 letters, digits, '.', '-' and '_' that does not begin with '.' or '-'. Such a name is
/// safe in a path and as an argument of a command.
[[nodiscard]] bool is_plain_name(std::string_view name);

/// True for a plain name, or one in a folder with a plain name: "tls/key.pem".
[[nodiscard]] bool is_path_of_plain_names(std::string_view path);

/// Copies `from`, with one level of subfolders, into the empty folder `to`. On return every copy is on the disk,
/// readable by this user only. Never follows a link.
///
/// Errors: kNotFound if there is no such folder; kInvalidArgument, naming the entry and the remedy, if the folder
/// contains a link, a device, a name that is not plain, a second level of subfolders, or more than `limits` allows;
/// kBadData if a file could not be read completely; kSystem if the copy could not be written, as on a full disk.
Result<CopiedFolder> copy_folder(const std::filesystem::path& from, const std::filesystem::path& to,
                                 const FolderLimits& limits = {});

/// Parses "HASH  NAME" lines as sha256sum writes them; names are plain, at most one folder deep. Errors: kBadData with
/// line and remedy.
Result<std::vector<CopiedFile>> parse_checksums(std::string_view text);
[[nodiscard]] std::string checksums_text(const std::vector<CopiedFile>& files);

/// Returns the hash in hexadecimal. Errors: kSystem if OpenSSL fails.
Result<std::string> sha256_of(std::string_view bytes);

}  // namespace cyclorama::provision
