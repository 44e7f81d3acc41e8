// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "drivers/camera/file/image_sequence.h"

namespace cyclorama::camera {

/// Photos (PNG, JPEG) as a recording: one file, or the photos of one folder in the order of their names.
class Photos final : public ImageSequence {
 public:
  static constexpr double kFramesPerSecond = 10.0;

  /// Reads the first photo, so that a mistake shows at once.
  /// Errors: kNotFound if there is no such file or folder, or the folder has no photo; kBadData if the first photo is
  /// damaged.
  static Result<std::unique_ptr<ImageSequence>> open(const std::filesystem::path& path);

  [[nodiscard]] double frames_per_second() const override { return kFramesPerSecond; }
  Result<std::optional<GreyImage>> picture(std::uint64_t index) override;
  [[nodiscard]] std::optional<std::uint64_t> count() const override { return files_.size(); }

 private:
  explicit Photos(std::vector<std::filesystem::path> files) : files_(std::move(files)) {}

  std::vector<std::filesystem::path> files_;
  std::uint64_t newest_index_ = 0;
  GreyImage newest_;  ///< Last photo read; a single photo is decoded only once.
};

}  // namespace cyclorama::camera
