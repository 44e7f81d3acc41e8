// SPDX-License-Identifier: Apache-2.0
/// Errors of a displayed picture against the displayed reference. Reentrant.
#pragma once

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama::quality {

struct ShownError {
  double psnr_db = 0.0;  ///< Infinite for equal pictures.
  double ssim = 0.0;
  double flip = 0.0;  ///< Mean over the picture.
};

/// Computes psnr(), ssim() and flip() together; errors are theirs.
Result<ShownError> shown_error(const RgbImage& picture, const RgbImage& reference);

}  // namespace cyclorama::quality
