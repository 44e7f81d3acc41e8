// SPDX-License-Identifier: Apache-2.0
/// How far linear light is from a reference: what sampling noise and bias are measured by. Reentrant. Errors of all:
/// check_comparable().
#pragma once

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama {

/// Keeps dark pixels from deciding alone; the value that published comparisons of renderers use.
inline constexpr double kRelativeErrorFloor = 0.01;

/// Mean over pixels and channels of (p - r)².
Result<double> mean_squared_error(const RadianceImage& picture, const RadianceImage& reference);

/// relMSE: mean over pixels and channels of (p - r)² / (r² + `floor`), with r the reference (Rousselle, Knaus and
/// Zwicker 2011). Precondition: `floor` is above 0.
Result<double> relative_squared_error(const RadianceImage& picture, const RadianceImage& reference,
                                      double floor = kRelativeErrorFloor);

}  // namespace cyclorama
