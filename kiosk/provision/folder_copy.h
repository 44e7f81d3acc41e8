// SPDX-License-Identifier: Apache-2.0
/// A stranger's folder, copied file by file into one of ours. What is checked afterwards is the copy, which nobody else
/// can change any more.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"

namespace cyclorama {

struct FolderLimits {
  std::size_t most_files = 200;
  std::size_t largest_bytes = std::size_t{64} << 20;  ///< Of one file: measured warps are the largest.
  std::size_t most_bytes = std::size_t{256} << 20;    ///< Of all.
};

/// With no more than a disk has room for, but 256 MiB for what runs beside; 1 MiB, for settings alone, always.
[[nodiscard]] FolderLimits within(std::uintmax_t available_bytes, FolderLimits limits);

struct CopiedFile {
  std::string name;  ///< "site.toml", "tls/key.pem".
  std::size_t bytes = 0;
  std::string sha256;  ///< In hexadecimal.
};

struct CopiedFolder {
  std::vector<CopiedFile> files;      ///< By name.
  std::vector<std::string> left_out;  ///< What computers put on sticks by themselves: ".Trashes", "desktop.ini".
};

/// Letters, digits, '.', '-', '_', at most 80, not beginning with '.' or '-'. Names become paths and words of commands.
[[nodiscard]] bool is_plain_name(std::string_view name);

/// Copies `from`, and the folders in it but none in those, into the empty folder `to`; every copy is on the disk when
/// it returns, readable by this user alone. Never follows a link.
///
/// kNotFound  no such folder.     kInvalidArgument  it holds a link, a device, a name that is not plain, a folder too
/// deep, or too much: names it, and what to do.     kBadData  a file could not be read whole.     kSystem  the copy
/// could not be written: the disk is full.
Result<CopiedFolder> copy_folder(const std::filesystem::path& from, const std::filesystem::path& to,
                                 const FolderLimits& limits = {});

/// "HASH  NAME" lines as sha256sum writes them; names are plain, in one folder at most.
/// kBadData  line and remedy.
Result<std::vector<CopiedFile>> parse_checksums(std::string_view text);
[[nodiscard]] std::string checksums_text(const std::vector<CopiedFile>& files);

/// In hexadecimal. kSystem  OpenSSL cannot.
Result<std::string> sha256_of(std::string_view bytes);

}  // namespace cyclorama
