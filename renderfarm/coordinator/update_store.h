// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "common/base/result.h"
#include "common/wire/updates.pb.h"
#include "renderfarm/scene_distribution/file_stamp.h"

namespace cyclorama::coordinator {

/// The farm's folder of system updates. It contains one folder per image, which holds the contents of the folder
/// `update/` that image/build created:
///
///   /srv/updates/cyclorama-museum/   SHA256SUMS  SHA256SUMS.sig  cyclorama-museum_V.efi  ..._UUID.root.raw
///   ..._UUID.verity.raw
///
/// Copy SHA256SUMS.sig last: a folder without it counts as having no version. The folder is read again for every
/// request, so new files need no restart. Only files that SHA256SUMS lists are served. Reentrant.
class UpdateStore {
 public:
  /// An empty folder name means that there are no updates.
  explicit UpdateStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Returns the current version of an image. Errors: kNotFound if there is no such image; kBadData if its files are
  /// incomplete or unreadable.
  [[nodiscard]] Result<wire::UpdateOffer> offer(const std::string& image) const;
  /// Opens the file that SHA256SUMS lists with this digest. Errors: those of offer(); kNotFound if the digest is not
  /// listed.
  [[nodiscard]] Result<scene_distribution::StampedFile> open(const std::string& image, const std::string& sha256) const;

 private:
  [[nodiscard]] Result<std::filesystem::path> folder_of(const std::string& image) const;

  std::filesystem::path folder_;
};

}  // namespace cyclorama::coordinator
