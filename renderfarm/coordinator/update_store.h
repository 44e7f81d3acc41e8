// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "common/base/result.h"
#include "common/wire/updates.pb.h"
#include "renderfarm/scene_distribution/file_stamp.h"

namespace cyclorama::coordinator {

/// The farm's folder of system updates. It has one folder per image, with the contents of the folder `update/` that
/// image/build made:
///
///   /srv/updates/cyclorama-museum/   SHA256SUMS  SHA256SUMS.sig  cyclorama-museum_V.efi  ..._UUID.root.raw
///   ..._UUID.verity.raw
///
/// Copy SHA256SUMS.sig last: without it there is no version. The folder is read anew at every request, so new files
/// need no restart. Only files that SHA256SUMS names are handed out. Reentrant.
class UpdateStore {
 public:
  /// An empty folder name means that there are no updates.
  explicit UpdateStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Errors: kNotFound if there is no such image; kBadData if its files are incomplete or unreadable.
  [[nodiscard]] Result<wire::UpdateOffer> offer(const std::string& image) const;
  /// Opens the file that SHA256SUMS lists with that digest. Errors: as offer(); kNotFound if it is not listed.
  [[nodiscard]] Result<scene_distribution::StampedFile> open(const std::string& image, const std::string& sha256) const;

 private:
  [[nodiscard]] Result<std::filesystem::path> folder_of(const std::string& image) const;

  std::filesystem::path folder_;
};

}  // namespace cyclorama::coordinator
