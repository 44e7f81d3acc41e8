// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/render/embree.h"

namespace cyclorama::render {

/// Embree filter function. Rejects hits in the holes of a cut-out material; where a material is partly transparent,
/// rejects them at random, with the ray's id as the seed. The geometry's user data is its SurfaceMesh. Reentrant.
void alpha_filter(const RTCFilterFunctionNArguments* arguments);
/// Rejects every hit. Reentrant.
void pass_all_filter(const RTCFilterFunctionNArguments* arguments);

}  // namespace cyclorama::render
