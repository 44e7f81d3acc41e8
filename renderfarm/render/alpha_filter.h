// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/render/embree.h"

namespace cyclorama::render {

/// Embree's filter function: rejects a hit in a hole of a cut-out material, and rejects it at random, by the ray's id,
/// where a material is partly transparent. The geometry's user data is its SurfaceMesh. Reentrant.
void alpha_filter(const RTCFilterFunctionNArguments* arguments);
/// Rejects every hit. Reentrant.
void pass_all_filter(const RTCFilterFunctionNArguments* arguments);

}  // namespace cyclorama::render
