// SPDX-License-Identifier: Apache-2.0
/// A museum hall for measurements: all surfaces are matte and flat-shaded and all lamps are rectangles at the ceiling,
/// so that any path tracer can render exactly this scene. The hall has columns, pedestals with vases and figures, and
/// benches, and is closed on all sides.
#pragma once

#include <cstdint>

#include "renderfarm/generator/grotto.h"

namespace cyclorama::generator {

inline constexpr int kMaxInteriorLamps = 10'000;

/// Plans the hall as plan_grotto() plans a grotto. The lamps hang in a grid. Their total area is always 9 m^2 and gives
/// the same light: four lamps are 1.5 x 1.5 m each, ten thousand 3 x 3 cm. Behind each lamp is a black tray, because
/// renderers differ in how they treat the back of a lamp. Errors: kInvalidArgument for too few triangles, or a number
/// of lamps outside [1, kMaxInteriorLamps].
Result<Grotto> plan_interior(std::uint64_t triangles, std::uint32_t seed, int lamps);

}  // namespace cyclorama::generator
