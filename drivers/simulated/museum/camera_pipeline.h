// SPDX-License-Identifier: Apache-2.0
/// What a webcam does to a picture after its sensor was read:
///
///   codes of 8 bits ─ noise reduction ─ sharpening ─ Motion JPEG ─▶ codes of 8 bits
#pragma once

#include <cstdint>

#include "common/image/image.h"

namespace cyclorama::simulated {

/// A value; reentrant.
struct CameraPipeline {
  double noise_reduction = 0.0;  ///< Part of a pixel's difference to its neighbours that is removed where it is small.
  double sharpening = 0.0;       ///< Part of a pixel's difference to its neighbours that is added.
  int jpeg_quality = 0;          ///< 1 to 100; 0: without JPEG.
  /// The camera exposes as it likes: so long that a picture's mean is this part of full scale. 0: as requested.
  double auto_exposure = 0.0;

  [[nodiscard]] bool is_plain() const { return noise_reduction == 0.0 && sharpening == 0.0 && jpeg_quality == 0; }
  /// Changes a picture of codes from 0 to `max_code`.
  void apply(Image<std::uint16_t, 1>* codes, int max_code) const;
  void apply(Image<std::uint16_t, 3>* codes, int max_code) const;
};

}  // namespace cyclorama::simulated
