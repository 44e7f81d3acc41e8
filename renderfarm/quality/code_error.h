// SPDX-License-Identifier: Apache-2.0
/// Errors of code values (8-bit sRGB, as displayed) against a reference. Reentrant. All functions have the errors of
/// check_same_size().
#pragma once

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama::quality {

/// Returns the peak signal-to-noise ratio in decibels: 10 log10(255² / mean over pixels and channels of (p - r)²);
/// infinite for equal pictures.
Result<double> psnr(const RgbImage& picture, const RgbImage& reference);

/// Side of SSIM's square window. A picture must be at least as large.
inline constexpr int kSsimWindowPx = 11;

/// Returns the structural similarity of luma (Rec. 601); 1 for equal pictures. Source: Wang, Bovik, Sheikh and
/// Simoncelli 2004, equation 13 averaged over all windows inside the picture (Gaussian, σ = 1.5 pixels, K1 = 0.01, K2 =
/// 0.03, L = 255). Errors: also kInvalidArgument if a side is below kSsimWindowPx.
Result<double> ssim(const RgbImage& picture, const RgbImage& reference);

}  // namespace cyclorama::quality
