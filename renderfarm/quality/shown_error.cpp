// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/quality/shown_error.h"

#include "renderfarm/quality/code_error.h"
#include "renderfarm/quality/flip.h"

namespace cyclorama::quality {

Result<ShownError> shown_error(const RgbImage& picture, const RgbImage& reference) {
  ShownError error;
  TRY_ASSIGN(error.psnr_db, psnr(picture, reference));
  TRY_ASSIGN(error.ssim, ssim(picture, reference));
  TRY_ASSIGN(const Flip difference, flip(picture, reference));
  error.flip = difference.mean;
  return error;
}

}  // namespace cyclorama::quality
