// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "common/base/result.h"
#include "common/update/update_manifest.h"

namespace cyclorama {

/// Where a version comes together, file by file, over nights and power cuts: NAME once it was verified, NAME.part
/// before. Another version takes the place of what there is. Thread-bound; one program at a time.
class UpdateFolder {
 public:
  /// Of that version; makes the folder. What belongs to another one is removed. kSystem.
  static Result<UpdateFolder> open(const std::filesystem::path& folder, const std::string& sums,
                                   const std::string& signature);

  [[nodiscard]] bool has(const UpdateFile& file) const;
  /// Bytes of it that are there already, of `bytes` in all: more than that are none.
  [[nodiscard]] std::uint64_t there(const UpdateFile& file, std::uint64_t bytes) const;
  /// What the disk has room for. kSystem.
  [[nodiscard]] Result<std::uint64_t> room() const;
  /// At its end. kSystem  the disk is full, or broken.
  Status append(const UpdateFile& file, std::span<const std::byte> bytes);
  /// All of it has come. kBadData  it is not what the manifest says, and gone.     kSystem.
  Status finish(const UpdateFile& file);
  void forget(const UpdateFile& file);

 private:
  explicit UpdateFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}
  [[nodiscard]] std::filesystem::path part(const UpdateFile& file) const { return folder_ / (file.name + ".part"); }

  std::filesystem::path folder_;
};

}  // namespace cyclorama
