// SPDX-License-Identifier: Apache-2.0
#include "drivers/camera/file/photos.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <system_error>

#include "common/image/image_file.h"

namespace cyclorama::camera {
namespace {

bool is_named_like_a_photo(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  constexpr std::array kEndings{".png", ".jpg", ".jpeg"};
  return std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end();
}

Result<std::vector<std::filesystem::path>> photos_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (is_named_like_a_photo(entry->path())) files.push_back(entry->path());
  }
  if (error) {
    return Error(ErrorCode::kSystem, fmt::format("listing folder '{}': {}", folder.string(), error.message()));
  }
  if (files.empty()) {
    return Error(ErrorCode::kNotFound,
                 fmt::format("folder '{}' holds no photo; put .png or .jpg files there", folder.string()));
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

Result<std::unique_ptr<ImageSequence>> Photos::open(const std::filesystem::path& path) {
  std::vector<std::filesystem::path> files{path};
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    TRY_ASSIGN(files, photos_in(path));
  }
  std::unique_ptr<Photos> photos(new Photos(std::move(files)));
  TRY_ASSIGN(photos->newest_, read_grey_image(photos->files_.front(), kPhotoLimitPx));
  return std::unique_ptr<ImageSequence>(std::move(photos));
}

Result<std::optional<GreyImage>> Photos::picture(std::uint64_t index) {
  if (index >= files_.size()) return std::optional<GreyImage>{};
  if (index != newest_index_) {
    TRY_ASSIGN(newest_, read_grey_image(files_[index], kPhotoLimitPx));
    newest_index_ = index;
  }
  return std::optional<GreyImage>(newest_);
}

}  // namespace cyclorama::camera
