// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "appliance/structured_light/decoded.h"

namespace cyclorama::structured_light {

/// Decoded fraction of a view, and its errors, estimated from the view alone: walls are smooth over some pixels, so
/// each tile of the photograph is compared with a plane that is fitted to it.
struct DecodeQuality {
  std::array<int, kPixelFates> fates = {};  ///< Number of pixels, by PixelFate.
  int lit = 0;                              ///< Pixels of at least the requested amplitude.
  double coverage = 0.0;                    ///< Fraction of the lit pixels that were decoded.
  /// Fraction of the decoded pixels in smooth tiles that are farther than kGrossPx from the tile's plane.
  double gross = 0.0;
  double residual_median_px = 0.0;  ///< Median distance from the tile's plane, over all but gross pixels.
  double residual_p99_px = 0.0;
  int judged = 0;  ///< Number of decoded pixels in smooth tiles.
};

inline constexpr double kGrossPx = 2.0;

/// Estimates the quality of a decoded view. `lit_amplitude` is in units of Photo. A tile is smooth if four in five of
/// its decoded pixels are within kGrossPx of one plane; other tiles contain an edge of the scene and are not judged.
/// Reentrant.
[[nodiscard]] DecodeQuality quality_of(const Decoded& decoded, double lit_amplitude);

}  // namespace cyclorama::structured_light
