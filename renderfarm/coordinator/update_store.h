// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "common/base/result.h"
#include "common/wire/updates.pb.h"
#include "renderfarm/scene_distribution/file_stamp.h"

namespace cyclorama::coordinator {

/// A farm's folder with, for each image by its name, the folder `update/` that image/build made:
///
///   /srv/updates/cyclorama-museum/   SHA256SUMS  SHA256SUMS.sig  cyclorama-museum_V.efi  ..._UUID.root.raw
///   ..._UUID.verity.raw
///
/// Copy SHA256SUMS.sig last: without it there is no version. Looked at anew with every question, so what is put there
/// needs no restart. It gives away what SHA256SUMS names and nothing else. Reentrant.
class UpdateStore {
 public:
  /// Empty: there is none.
  explicit UpdateStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// kNotFound  no such image.     kBadData  what lies there is not whole, or cannot be read.
  [[nodiscard]] Result<wire::UpdateOffer> offer(const std::string& image) const;
  /// By what SHA256SUMS says of it. Errors as offer(), and kNotFound.
  [[nodiscard]] Result<scene_distribution::StampedFile> open(const std::string& image, const std::string& sha256) const;

 private:
  [[nodiscard]] Result<std::filesystem::path> folder_of(const std::string& image) const;

  std::filesystem::path folder_;
};

}  // namespace cyclorama::coordinator
