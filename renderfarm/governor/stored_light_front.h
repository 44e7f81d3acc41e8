// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/governor/front.h"

namespace cyclorama::governor {

/// Returns the Pareto front for a scene with stored light (renderfarm/light). Its cheaper pictures use that light, so
/// they are free of noise at any size; the most expensive picture traces paths, like a picture at rest. `bounces` is
/// the scene's number of bounces, for the parts that are traced nevertheless.
[[nodiscard]] ParetoFront stored_light_front(int bounces);
/// Returns true if any picture of the front uses stored light.
[[nodiscard]] bool uses_stored_light(const ParetoFront& front);

}  // namespace cyclorama::governor
