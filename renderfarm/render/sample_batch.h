// SPDX-License-Identifier: Apache-2.0
/// The random numbers of many samples at once: what SampleSequence gives one by one, in loops that compile to vectors.
#pragma once

#include <cstdint>

namespace cyclorama {

/// ret_u[i], ret_v[i] = the point of the unit square that SampleSequence::pair(dimension) is for a sequence of that
/// state. Arrays of `count`, which may not overlap. Reentrant.
void sample_pairs(int count, const std::uint32_t* index_reversed, const std::uint32_t* seed, std::uint32_t dimension,
                  float* ret_u, float* ret_v);

}  // namespace cyclorama
