// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "common/base/result.h"
#include "common/update/update_manifest.h"

namespace cyclorama::update {

/// Collects the files of a version over several nights and power cuts: a file is NAME.part until it is verified, then
/// NAME. A new version replaces an older one. Thread-bound; used by one program at a time.
class UpdateFolder {
 public:
  /// Makes the folder for the version with these sums; removes the files of any other version. Errors: kSystem.
  static Result<UpdateFolder> open(const std::filesystem::path& folder, const std::string& sums,
                                   const std::string& signature);

  [[nodiscard]] bool has(const UpdateFile& file) const;
  /// Returns how many of the file's `bytes` have arrived; 0 if the file is longer than that.
  [[nodiscard]] std::uint64_t there(const UpdateFile& file, std::uint64_t bytes) const;
  /// Returns the free space of the disk in bytes. Errors: kSystem.
  [[nodiscard]] Result<std::uint64_t> room() const;
  /// Appends bytes to a file. Errors: kSystem if the disk is full or broken.
  Status append(const UpdateFile& file, std::span<const std::byte> bytes);
  /// Verifies a complete file. Errors: kBadData if it differs from the manifest, in which case it is removed; kSystem.
  Status finish(const UpdateFile& file);
  void forget(const UpdateFile& file);

 private:
  explicit UpdateFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}
  [[nodiscard]] std::filesystem::path part(const UpdateFile& file) const { return folder_ / (file.name + ".part"); }

  std::filesystem::path folder_;
};

}  // namespace cyclorama::update
