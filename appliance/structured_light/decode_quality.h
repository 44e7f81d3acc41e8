// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "appliance/structured_light/decoded.h"

namespace cyclorama::structured_light {

/// The decoded fraction of a view and its errors, as far as the view itself shows them: walls are smooth over some
/// pixels, so each tile of the photograph is compared with a plane of its own.
struct DecodeQuality {
  std::array<int, kPixelFates> fates = {};  ///< Pixels, by PixelFate.
  int lit = 0;                              ///< Pixels of at least the requested amplitude.
  double coverage = 0.0;                    ///< Fraction of the lit pixels that were decoded.
  /// Fraction of the decoded pixels in smooth tiles that are farther than kGrossPx from the tile's plane.
  double gross = 0.0;
  double residual_median_px = 0.0;  ///< Median distance on the projector from the tile's plane, over the other pixels.
  double residual_p99_px = 0.0;
  int judged = 0;  ///< Decoded pixels in smooth tiles.
};

inline constexpr double kGrossPx = 2.0;

/// `lit_amplitude` as Photo. A tile is smooth if four in five of its decoded pixels lie within kGrossPx of one plane;
/// other tiles hold an edge of the scene and are not judged. Reentrant.
[[nodiscard]] DecodeQuality quality_of(const Decoded& decoded, double lit_amplitude);

}  // namespace cyclorama::structured_light
