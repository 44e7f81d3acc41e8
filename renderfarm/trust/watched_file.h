// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/stat.h>

#include <filesystem>
#include <optional>
#include <string>

#include "common/base/result.h"

namespace cyclorama::trust {

/// A small text file that may be replaced while the program runs. Thread-bound.
class WatchedFile {
 public:
  WatchedFile() = default;
  explicit WatchedFile(std::filesystem::path path) : path_(std::move(path)) {}

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Returns the content, or an error of read_text_file(), on the first call and whenever the file has changed since
  /// the previous call; otherwise nothing.
  std::optional<Result<std::string>> changed();

 private:
  std::filesystem::path path_;
  bool asked_ = false;
  std::optional<struct ::stat> seen_;  ///< Empty while the file is missing.
};

}  // namespace cyclorama::trust
