// SPDX-License-Identifier: Apache-2.0
/// Heads of statues: of a Buddha (curls, ushnisha, long earlobes, half-closed eyes) and of a monk (shaven).
#pragma once

#include "renderfarm/generator/sculpture.h"

namespace cyclorama::generator {

struct StatueHeadStyle {
  bool buddha = true;
  Vec3 skin = Vec3::Ones();
  float sorrow = 0.0f;  ///< 0 is calm; 1 raises the inner ends of the brows and lowers the corners of the mouth.
  float age = 0.0f;     ///< 1 is gaunt.
};

/// Returns a head. One unit is half the height from chin to crown; the origin is inside the head, between the eyes. The
/// neck extends down to -1.6.
[[nodiscard]] Sculpture statue_head(const StatueHeadStyle& style);

}  // namespace cyclorama::generator
