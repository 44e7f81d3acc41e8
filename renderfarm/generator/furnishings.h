// SPDX-License-Identifier: Apache-2.0
/// Lamps: their geometry and their light.
#pragma once

#include <string>
#include <vector>

#include "renderfarm/generator/surface.h"
#include "renderfarm/generator/vec.h"

namespace cyclorama::generator {

/// A [[lamp]] of the scene package; the fields are its keys.
struct Lamp {
  std::string name;
  std::string kind;  ///< "point", "spot" or "rectangle".
  Vec3 position;
  Vec3 direction = -Vec3::UnitY();
  Vec3 intensity_cd = Vec3::Zero();
  float radius_m = 0.0f;
  float inner_cone_deg = 0.0f;
  float outer_cone_deg = 45.0f;
  float side_m = 0.0f;            ///< For a rectangle: side of the square.
  Vec3 luminance = Vec3::Zero();  ///< For a rectangle: radiance.
};

/// Returns the butter lamps on the altar's ledge and on two stands before the altar.
[[nodiscard]] std::vector<Patch> lamp_bodies();

/// Returns the lights of the butter lamps, of the daylight in the corridor, and of the museum's lighting.
[[nodiscard]] std::vector<Lamp> lamp_lights();

}  // namespace cyclorama::generator
