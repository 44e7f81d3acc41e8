// SPDX-License-Identifier: Apache-2.0
/// A museum hall for measuring: every surface is matte and flat-shaded, every lamp is a rectangle at the ceiling, so
/// that any path tracer can show exactly this scene. Columns, pedestals with vases and figures, benches; closed all
/// around.
#pragma once

#include <cstdint>

#include "renderfarm/generator/grotto.h"

namespace cyclorama::grotto {

inline constexpr int kMostInteriorLamps = 10'000;

/// As plan_grotto(). The lamps hang in a grid. However many there are, together they have 9 m^2 and the same light:
/// four are 1.5 x 1.5 m, ten thousand 3 x 3 cm. Behind each is a black tray: renderers differ in what the back of a
/// lamp does. kInvalidArgument for too few triangles, or a number of lamps outside [1, kMostInteriorLamps].
Result<Grotto> plan_interior(std::uint64_t triangles, std::uint32_t seed, int lamps);

}  // namespace cyclorama::grotto
