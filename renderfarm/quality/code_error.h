// SPDX-License-Identifier: Apache-2.0
/// How far code values (8-bit sRGB, what a display shows) are from a reference. Reentrant. Errors of all:
/// check_same_size().
#pragma once

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama {

/// Peak signal to noise, decibels: 10 log10(255² / mean over pixels and channels of (p - r)²). Infinite for equal
/// pictures.
Result<double> psnr(const RgbImage& picture, const RgbImage& reference);

/// SSIM's window is square; a picture must hold it once.
inline constexpr int kSsimWindowPx = 11;

/// Structural similarity of luma (Rec. 601), 1 for equal pictures: Wang, Bovik, Sheikh and Simoncelli 2004, equation
/// 13 averaged over all windows inside the picture (Gaussian, σ = 1.5 pixels, K1 = 0.01, K2 = 0.03, L = 255).
/// kInvalidArgument  also when a side is below kSsimWindowPx.
Result<double> ssim(const RgbImage& picture, const RgbImage& reference);

}  // namespace cyclorama
