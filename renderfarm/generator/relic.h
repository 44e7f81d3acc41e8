// SPDX-License-Identifier: Apache-2.0
/// A single figure before an empty background, for measurements: nearly all of the rendering cost is in a part of the
/// picture.
#pragma once

#include <cstdint>

#include "renderfarm/generator/grotto.h"

namespace cyclorama::generator {

/// Same contract as plan_grotto(), for a Buddha in meditation, about 1.2 m high, between two lamps.
Result<Grotto> plan_relic(std::uint64_t triangles, std::uint32_t seed);

}  // namespace cyclorama::generator
