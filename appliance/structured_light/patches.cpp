// SPDX-License-Identifier: Apache-2.0
#include "appliance/structured_light/patches.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace cyclorama::structured_light {
namespace {

/// Union-find over pixels.
class Union {
 public:
  explicit Union(std::size_t count) : parents_(count) { std::iota(parents_.begin(), parents_.end(), 0U); }
  std::uint32_t root_of(std::uint32_t i) {
    while (parents_[i] != i) {
      parents_[i] = parents_[parents_[i]];
      i = parents_[i];
    }
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = root_of(a);
    b = root_of(b);
    if (a != b) parents_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parents_;
};

bool is_decoded(const Decoded& decoded, std::size_t i) { return decoded.fate.data()[i] == PixelFate::kDecoded; }

/// Returns the distance between two pixels' positions: the maximum over the projector's two axes.
float distance(const Decoded& decoded, std::size_t a, std::size_t b) {
  const auto positions = decoded.position_px.data();
  return std::max(std::abs(positions[2 * a] - positions[2 * b]), std::abs(positions[2 * a + 1] - positions[2 * b + 1]));
}

/// Returns the median distance between neighbours, from some ten thousand pixels.
float usual_step(const Decoded& decoded, std::size_t stride) {
  const std::size_t count = decoded.fate.data().size();
  const std::size_t every = std::max<std::size_t>(1, count / 20000);
  std::vector<float> steps;
  for (std::size_t i = 0; i + stride < count; i += every) {
    if (is_decoded(decoded, i) && is_decoded(decoded, i + stride)) steps.push_back(distance(decoded, i, i + stride));
  }
  if (steps.empty()) return 0.0f;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

}  // namespace

void remove_small_patches(int min_patch_px, Decoded* decoded) {
  const auto width = static_cast<std::size_t>(decoded->fate.width());
  const auto height = static_cast<std::size_t>(decoded->fate.height());
  const std::size_t count = width * height;
  Union patches(count);
  for (const std::size_t stride : {std::size_t{1}, width}) {
    const float max = 1.0f + 2.0f * usual_step(*decoded, stride);
    for (std::size_t y = 0; y + (stride == width ? 1 : 0) < height; ++y) {
      for (std::size_t x = 0; x + (stride == 1 ? 1 : 0) < width; ++x) {
        const std::size_t i = y * width + x;
        if (is_decoded(*decoded, i) && is_decoded(*decoded, i + stride) && distance(*decoded, i, i + stride) <= max) {
          patches.join(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(i + stride));
        }
      }
    }
  }
  std::vector<int> sizes(count, 0);
  for (std::size_t i = 0; i < count; ++i) ++sizes[patches.root_of(static_cast<std::uint32_t>(i))];
  for (std::size_t i = 0; i < count; ++i) {
    if (is_decoded(*decoded, i) && sizes[patches.root_of(static_cast<std::uint32_t>(i))] < min_patch_px) {
      decoded->fate.data()[i] = PixelFate::kContradictsNeighbours;
    }
  }
}

}  // namespace cyclorama::structured_light
