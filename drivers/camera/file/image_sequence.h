// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama::camera {

/// Ordered pictures on disk. Read by FileCamera; implemented by Photos and Video. Thread-bound.
class ImageSequence {
 public:
  virtual ~ImageSequence() = default;

  /// Nominal picture rate of the recording.
  [[nodiscard]] virtual double frames_per_second() const = 0;
  /// Returns picture `index`, counted from 0, or nothing if the recording ends before it. Reading in ascending order is
  /// fastest.
  /// Errors: kBadData, kNotFound or kSystem if that picture cannot be read; the message names the file.
  virtual Result<std::optional<GreyImage>> picture(std::uint64_t index) = 0;
  /// Number of pictures; nothing while it is unknown, that is, until a video was read to its end.
  [[nodiscard]] virtual std::optional<std::uint64_t> count() const = 0;

 protected:
  ImageSequence() = default;
  ImageSequence(const ImageSequence&) = delete;
  ImageSequence& operator=(const ImageSequence&) = delete;
};

}  // namespace cyclorama::camera
