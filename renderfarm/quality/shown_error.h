// SPDX-License-Identifier: Apache-2.0
/// Errors of a picture, as displayed, against a reference. Reentrant.
#pragma once

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama::quality {

struct ShownError {
  double psnr_db = 0.0;  ///< Infinite for equal pictures.
  double ssim = 0.0;
  double flip = 0.0;  ///< Mean FLIP over the picture.
};

/// Computes psnr(), ssim() and flip(). Errors: those of these functions.
Result<ShownError> shown_error(const RgbImage& picture, const RgbImage& reference);

}  // namespace cyclorama::quality
