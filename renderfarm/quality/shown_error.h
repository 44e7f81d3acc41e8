// SPDX-License-Identifier: Apache-2.0
/// How far what a display shows is from what it would show of the reference. Reentrant.
#pragma once

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama {

struct ShownError {
  double psnr_db = 0.0;  ///< Infinite for equal pictures.
  double ssim = 0.0;
  double flip = 0.0;  ///< Its mean.
};

/// psnr(), ssim() and flip() at once; their errors.
Result<ShownError> shown_error(const RgbImage& picture, const RgbImage& reference);

}  // namespace cyclorama
