// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "appliance/structured_light/decoded.h"

namespace cyclorama::structured_light {

/// How much of a view was decoded, and how much of that is wrong, as far as the view itself can tell: walls are smooth
/// over some pixels, so tiles of the photograph are each compared with their own plane.
struct DecodeQuality {
  std::array<int, kPixelFates> fates = {};  ///< Pixels, by PixelFate.
  int lit = 0;                              ///< Pixels of at least the amplitude asked for.
  double coverage = 0.0;                    ///< Of the lit pixels, those decoded.
  double gross = 0.0;  ///< Of the decoded pixels in smooth tiles, those further than kGrossPx from the tile's plane.
  double residual_median_px = 0.0;  ///< Distance on the projector from the tile's plane, of the others.
  double residual_p99_px = 0.0;
  int judged = 0;  ///< Decoded pixels in smooth tiles.
};

inline constexpr double kGrossPx = 2.0;

/// `lit_amplitude` as Photo. A tile is smooth when four in five of its decoded pixels lie within kGrossPx of one plane;
/// one that is not holds an edge of the scene and judges nobody. Reentrant.
[[nodiscard]] DecodeQuality quality_of(const Decoded& decoded, double lit_amplitude);

}  // namespace cyclorama::structured_light
