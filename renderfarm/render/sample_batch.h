// SPDX-License-Identifier: Apache-2.0
/// Random numbers of many samples at once, equal to those of SampleSequence, in loops that compile to vector code.
#pragma once

#include <cstdint>

namespace cyclorama::render {

/// Sets (ret_u[i], ret_v[i]) to SampleSequence::pair(dimension) for a sequence of the given state. The arrays have
/// `count` elements and must not overlap. Reentrant.
void sample_pairs(int count, const std::uint32_t* index_reversed, const std::uint32_t* seed, std::uint32_t dimension,
                  float* ret_u, float* ret_v);

}  // namespace cyclorama::render
