// SPDX-License-Identifier: Apache-2.0
/// The samples of one triangle on a grid (light/light_store.h), and what is done to their light without new rays.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "renderfarm/light_baking/light_tracer.h"

namespace cyclorama::light_baking {

/// The light at a point of a grid; that of lamps alone while the grid is made.
struct ProbeLight {
  render::Vec3 light = render::Vec3::Zero();
  float error = 0.0f;  ///< Standard error of its luminance.
};

/// The samples of a triangle, on a grid. A sample that something separates from its neighbour is marked as unusable.
struct MadeGrid {
  std::uint32_t triangle = 0;
  int parts = 0;
  std::vector<ProbeLight> light;       ///< Without the ambient light.
  std::vector<std::uint8_t> separate;  ///< 1 for samples that must not be used.
};

/// Steps from a sample to its neighbours, chosen so that each pair occurs once.
inline constexpr std::array<std::pair<int, int>, 3> kNeighbours = {{{1, 0}, {0, 1}, {-1, 1}}};

/// Calls visit(column, row) for each sample of a grid, in the order in which they are stored.
template <typename Visit>
void for_each_sample(int parts, Visit visit) {
  for (int j = 0; j <= parts; ++j) {
    for (int i = 0; i + j <= parts; ++i) visit(i, j);
  }
}

/// Calls visit(i, j, k, l) for each pair of neighbours (i, j) and (k, l), once. The sample between them has the place
/// (i + k, j + l) in a grid of twice as many parts.
template <typename Visit>
void for_each_pair(int parts, Visit visit) {
  for_each_sample(parts, [&](int i, int j) {
    for (const auto& [di, dj] : kNeighbours) {
      if (i + di >= 0 && i + di + j + dj <= parts) visit(i, j, i + di, j + dj);
    }
  });
}

/// Returns the mean of two samples.
[[nodiscard]] ProbeLight mean(const ProbeLight& a, const ProbeLight& b);

[[nodiscard]] std::vector<ProbeLight> as_probes(std::span<const GatheredLight> gathered);

/// Smooths the light of a grid of `parts` between samples that are not `separate`, of which there may be none.
[[nodiscard]] std::vector<ProbeLight> smoothed(std::span<const std::uint8_t> separate, int parts,
                                               std::vector<GatheredLight> light);

/// Doubles the parts of a grid. New samples are interpolated.
void refine(MadeGrid* grid);

/// Adds the light `coarse` of another grid of the same triangle to `grid`. The other grid has `parts` parts along an
/// edge, at most as many as `grid` has. Its light is interpolated.
void add(int parts, const std::vector<ProbeLight>& coarse, MadeGrid* grid);

}  // namespace cyclorama::light_baking
