// SPDX-License-Identifier: Apache-2.0
/// A museum hall for measurements: all surfaces are matte and flat-shaded and all lamps are rectangles at the ceiling,
/// so that any path tracer can render exactly this scene. Columns, pedestals with vases and figures, benches; closed on
/// all sides.
#pragma once

#include <cstdint>

#include "renderfarm/generator/grotto.h"

namespace cyclorama::generator {

inline constexpr int kMaxInteriorLamps = 10'000;

/// Same contract as plan_grotto(). The lamps hang in a grid. Their total area is always 9 m^2 with the same light: four
/// are 1.5 x 1.5 m, ten thousand 3 x 3 cm. Behind each is a black tray, because renderers treat the back of a lamp
/// differently. Errors: kInvalidArgument for too few triangles, or a number of lamps outside [1, kMaxInteriorLamps].
Result<Grotto> plan_interior(std::uint64_t triangles, std::uint32_t seed, int lamps);

}  // namespace cyclorama::generator
