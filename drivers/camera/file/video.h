// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "drivers/camera/file/image_sequence.h"

namespace cyclorama::camera {

/// A video file (MP4, Matroska or AVI, with a codec that libavcodec supports) as a recording of grey pictures. It
/// decodes forwards, so an index below the last one restarts from the beginning.
class Video final : public ImageSequence {
 public:
  /// Errors: kNotFound if there is no such file; kBadData if it is not an MP4, Matroska or AVI file, is damaged, has no
  /// pictures that libavcodec can decode, or has pictures of more than kPhotoLimitPx pixels.
  static Result<std::unique_ptr<ImageSequence>> open(const std::filesystem::path& path);
  ~Video() override;

  /// Mean rate; a recording with a varying rate is replayed evenly.
  [[nodiscard]] double frames_per_second() const override { return frames_per_second_; }
  Result<std::optional<GreyImage>> picture(std::uint64_t index) override;
  [[nodiscard]] std::optional<std::uint64_t> count() const override { return count_; }

 private:
  struct Decoder;
  Video();
  Status reopen();

  std::filesystem::path path_;
  std::unique_ptr<Decoder> decoder_;
  double frames_per_second_ = 0.0;
  std::uint64_t next_ = 0;  ///< Index of the picture that the decoder returns next.
  std::optional<std::uint64_t> count_;
  GreyImage newest_;
};

}  // namespace cyclorama::camera
