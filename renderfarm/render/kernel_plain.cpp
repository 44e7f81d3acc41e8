// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/integrator.h"

namespace cyclorama {

Kernel plain_kernel(const SceneNeeds& needs) { return kernel_with<false, false>(needs); }

}  // namespace cyclorama
