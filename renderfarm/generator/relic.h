// SPDX-License-Identifier: Apache-2.0
/// One figure before nothing, for measuring: nearly all that the picture costs is in a part of it.
#pragma once

#include <cstdint>

#include "renderfarm/generator/grotto.h"

namespace cyclorama::grotto {

/// As plan_grotto(): a Buddha in meditation, about 1.2 m high, between two lamps.
Result<Grotto> plan_relic(std::uint64_t triangles, std::uint32_t seed);

}  // namespace cyclorama::grotto
