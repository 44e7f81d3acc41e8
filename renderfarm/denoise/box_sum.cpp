// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/denoise/box_sum.h"

#include <algorithm>

#include "common/base/vector_clones.h"

namespace cyclorama::denoise {
namespace {

CYCLORAMA_VECTOR_CLONES
void add_row(float* __restrict to, const float* __restrict from, int count) {
  for (int i = 0; i < count; ++i) to[i] += from[i];
}

}  // namespace

void box_sum(const Plane& plane, int radius, Plane* scratch, Plane* ret_sum) {
  const int width = plane.width();
  const int height = plane.height();
  scratch->reshape(width, height);
  std::fill(scratch->data().begin(), scratch->data().end(), 0.0f);
  for (int y = 0; y < height; ++y) {
    for (int dx = -radius; dx <= radius; ++dx) {
      const int first = std::max(0, -dx);
      const int count = std::min(width, width - dx) - first;
      if (count > 0) add_row(scratch->at(first, y), plane.at(first + dx, y), count);
    }
  }
  ret_sum->reshape(width, height);
  std::fill(ret_sum->data().begin(), ret_sum->data().end(), 0.0f);
  for (int y = 0; y < height; ++y) {
    for (int from = std::max(0, y - radius); from <= std::min(height - 1, y + radius); ++from) {
      add_row(ret_sum->at(0, y), scratch->at(0, from), width);
    }
  }
}

}  // namespace cyclorama::denoise
