// SPDX-License-Identifier: Apache-2.0
/// Which settings are measured to learn how time and bytes are traded for accuracy.
#pragma once

#include <string>
#include <vector>

#include "renderfarm/render/picture_quality.h"

namespace cyclorama {

/// The knob by which a setting differs from the base; "together" where several do.
struct PlannedPoint {
  std::string knob;
  PictureQuality quality;
};

/// In the middle of every knob's range: each curve goes through it.
[[nodiscard]] PictureQuality trade_base();

/// Not every combination: each knob is turned alone around the base, which gives its curve; the knobs that decide most
/// of the time (samples, bounces, scale, and the denoiser) are turned together, which gives the front. Every setting is
/// legal and comes once. `quick` leaves most out. Pictures that differ only in how they are sent follow one another.
[[nodiscard]] std::vector<PlannedPoint> trade_plan(bool quick);

}  // namespace cyclorama
