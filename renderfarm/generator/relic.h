// SPDX-License-Identifier: Apache-2.0
/// A single figure before an empty background, for measurements in which nearly all of the rendering cost is in one
/// part of the picture.
#pragma once

#include <cstdint>

#include "renderfarm/generator/grotto.h"

namespace cyclorama::generator {

/// Plans a Buddha in meditation, about 1.2 m high, between two lamps, as plan_grotto() plans a grotto.
Result<Grotto> plan_relic(std::uint64_t triangles, std::uint32_t seed);

}  // namespace cyclorama::generator
