// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/render/embree.h"

namespace cyclorama {

/// Embree asks at every hit whether it counts: not where a cut-out material has a hole, and by lot (drawn from the
/// ray's id) where a material is half transparent. The geometry's user data is its SurfaceMesh.
/// Reentrant.
void alpha_filter(const RTCFilterFunctionNArguments* arguments);

}  // namespace cyclorama
