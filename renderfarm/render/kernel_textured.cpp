// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/integrator.h"

namespace cyclorama {

Kernel textured_kernel(const SceneNeeds& needs) { return kernel_with<true, false>(needs); }

}  // namespace cyclorama
