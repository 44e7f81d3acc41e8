// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/kernel.h"

#include "renderfarm/render/integrator.h"

namespace cyclorama {

Kernel kernel_for(const SceneNeeds& needs) {
  if (needs.normal_maps) return normal_mapped_kernel(needs);
  if (needs.textures) return textured_kernel(needs);
  return plain_kernel(needs);
}

}  // namespace cyclorama
