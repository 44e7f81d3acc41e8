// SPDX-License-Identifier: Apache-2.0
/// Errors of linear light against a reference; they measure sampling noise and bias. Reentrant. All functions have the
/// errors of check_comparable().
#pragma once

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama::quality {

/// Floor of the denominator, which prevents dark pixels from dominating. Published comparisons of renderers use this
/// value.
inline constexpr double kRelativeErrorFloor = 0.01;

/// Returns the mean over pixels and channels of (p - r)².
Result<double> mean_squared_error(const RadianceImage& picture, const RadianceImage& reference);

/// Returns relMSE: the mean over pixels and channels of (p - r)² / (r² + `floor`), with r the reference (Rousselle,
/// Knaus and Zwicker 2011). Precondition: `floor` is above 0.
Result<double> relative_squared_error(const RadianceImage& picture, const RadianceImage& reference,
                                      double floor = kRelativeErrorFloor);

}  // namespace cyclorama::quality
