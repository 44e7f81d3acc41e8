// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama::camera {

/// Pictures on disk, in order. Read by FileCamera; implemented by Photos and Video. Thread-bound.
class ImageSequence {
 public:
  virtual ~ImageSequence() = default;

  /// Pictures per second that the recording itself asks for.
  [[nodiscard]] virtual double frames_per_second() const = 0;
  /// Picture `index`, counted from 0 from the beginning; nothing when the recording ends before it. An index above the
  /// last one asked for is quickest.
  /// kBadData, kNotFound, kSystem  that picture cannot be read; the message names the file.
  virtual Result<std::optional<GreyImage>> picture(std::uint64_t index) = 0;
  /// How many pictures there are; nothing while that is not known, which is until a video was read to its end.
  [[nodiscard]] virtual std::optional<std::uint64_t> count() const = 0;

 protected:
  ImageSequence() = default;
  ImageSequence(const ImageSequence&) = delete;
  ImageSequence& operator=(const ImageSequence&) = delete;
};

}  // namespace cyclorama::camera
