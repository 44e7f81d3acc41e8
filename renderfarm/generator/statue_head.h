// SPDX-License-Identifier: Apache-2.0
/// Heads of statues: of a Buddha (curls, knob of wisdom, long lobes, half-closed eyes) and of a monk (shaven).
#pragma once

#include "renderfarm/generator/sculpture.h"

namespace cyclorama::grotto {

struct StatueHeadStyle {
  bool buddha = true;
  Vec3 skin = Vec3::Ones();
  float sorrow = 0.0f;  ///< 0 calm; 1 draws the inner ends of the brows up and the corners of the mouth down.
  float age = 0.0f;     ///< 1 is gaunt.
};

/// One unit is half the height from chin to crown; the origin lies between the eyes, inside. The neck goes down to
/// -1.6.
[[nodiscard]] Sculpture statue_head(const StatueHeadStyle& style);

}  // namespace cyclorama::grotto
