// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/integrator.h"

namespace cyclorama {

Kernel normal_mapped_kernel(const SceneNeeds& needs) { return kernel_with<true, true>(needs); }

}  // namespace cyclorama
