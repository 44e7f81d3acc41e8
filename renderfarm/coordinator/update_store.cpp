// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/update_store.h"

#include <fmt/format.h>

#include "common/base/file.h"
#include "common/base/text.h"
#include "common/update/update_manifest.h"

namespace cyclorama::coordinator {
namespace {

Error none(const std::string& image) {
  return Error(ErrorCode::kNotFound, fmt::format("this farm has no version of '{}'", printable(image, 100)));
}

/// Returns an error without paths on the farm's host, which are of no use to a museum.
Error unreadable() {
  return Error(ErrorCode::kBadData,
               "the files in the farm's folder of updates cannot be read; its operator must copy them again");
}

}  // namespace

Result<std::filesystem::path> UpdateStore::folder_of(const std::string& image) const {
  std::error_code failed;
  if (folder_.empty() || !is_image_name(image) ||
      !std::filesystem::exists(folder_ / image / kUpdateSignature, failed)) {
    return none(image);
  }
  return folder_ / image;
}

Result<wire::UpdateOffer> UpdateStore::offer(const std::string& image) const {
  TRY_ASSIGN(const std::filesystem::path folder, folder_of(image));
  auto sums = read_text_file(folder / kUpdateSums, kMaxUpdateTextBytes);
  auto signature = read_text_file(folder / kUpdateSignature, kMaxUpdateTextBytes);
  if (!sums) return unreadable();
  if (!signature) return unreadable();
  TRY_ASSIGN(const UpdateManifest manifest, parse_update_manifest(*sums, image));
  wire::UpdateOffer offer;
  offer.set_sums(*std::move(sums));
  offer.set_signature(*std::move(signature));
  for (const UpdateFile& file : manifest.files) {
    const auto opened = scene_distribution::open_stamped(folder / file.name);
    if (!opened) return unreadable();
    offer.add_bytes(opened->stamp.bytes);
  }
  return offer;
}

Result<scene_distribution::StampedFile> UpdateStore::open(const std::string& image, const std::string& sha256) const {
  TRY_ASSIGN(const std::filesystem::path folder, folder_of(image));
  const auto sums = read_text_file(folder / kUpdateSums, kMaxUpdateTextBytes);
  if (!sums) return unreadable();
  TRY_ASSIGN(const UpdateManifest manifest, parse_update_manifest(*sums, image));
  for (const UpdateFile& file : manifest.files) {
    if (file.sha256 != sha256) continue;
    auto opened = scene_distribution::open_stamped(folder / file.name);
    if (!opened) return unreadable();
    return opened;
  }
  return Error(ErrorCode::kNotFound, "the farm has another version by now");
}

}  // namespace cyclorama::coordinator
