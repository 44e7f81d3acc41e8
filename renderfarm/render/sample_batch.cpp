// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/sample_batch.h"

#include "common/base/vector_clones.h"
#include "renderfarm/render/sampler.h"

namespace cyclorama::render {

CYCLORAMA_VECTOR_CLONES
void sample_pairs(int count, const std::uint32_t* __restrict index_reversed, const std::uint32_t* __restrict seed,
                  std::uint32_t dimension, float* __restrict ret_u, float* __restrict ret_v) {
  for (int i = 0; i < count; ++i) {
    const SobolPoint point = sobol_point(index_reversed[i], seed[i], dimension);
    ret_u[i] = point.u;
    ret_v[i] = point.v;
  }
}

}  // namespace cyclorama::render
