// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/governor/front.h"

namespace cyclorama::governor {

/// Returns the Pareto front for a scene with light that was computed ahead (renderfarm/light). Its cheap pictures read
/// that light, so they are free of noise at any size; the most expensive one traces paths, like the picture at rest.
/// `bounces` are the scene's, for the parts that are traced nevertheless.
[[nodiscard]] ParetoFront stored_light_front(int bounces);
/// Returns true if some picture of the front reads light that was computed ahead.
[[nodiscard]] bool uses_stored_light(const ParetoFront& front);

}  // namespace cyclorama::governor
