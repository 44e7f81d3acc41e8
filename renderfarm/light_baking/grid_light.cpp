// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light_baking/grid_light.h"

#include <algorithm>
#include <cmath>

#include "renderfarm/light/light_store.h"
#include "renderfarm/light_baking/smoothing.h"

namespace cyclorama::light_baking {
namespace {

using light::TriangleGrid;

/// Returns the light at a position between samples.
ProbeLight interpolated(const std::vector<ProbeLight>& light, int parts, float u, float v) {
  const int j = std::min(static_cast<int>(v), parts - 1);
  const int i = std::min(static_cast<int>(u), parts - 1 - j);
  u -= static_cast<float>(i);
  v -= static_cast<float>(j);
  const auto at = [&](int column, int row) -> const ProbeLight& {
    return light[static_cast<std::size_t>(TriangleGrid::index(parts, column, row))];
  };
  const auto mixed = [](const ProbeLight& a, float weight_a, const ProbeLight& b, float weight_b, const ProbeLight& c,
                        float weight_c) -> ProbeLight {
    return {weight_a * a.light + weight_b * b.light + weight_c * c.light,
            weight_a * a.error + weight_b * b.error + weight_c * c.error};
  };
  if (u + v <= 1.0f || i + j == parts - 1) return mixed(at(i, j), 1.0f - u - v, at(i + 1, j), u, at(i, j + 1), v);
  return mixed(at(i + 1, j + 1), u + v - 1.0f, at(i, j + 1), 1.0f - u, at(i + 1, j), 1.0f - v);
}

}  // namespace

ProbeLight mean(const ProbeLight& a, const ProbeLight& b) {
  return {0.5f * (a.light + b.light), 0.5f * (a.error + b.error)};
}

std::vector<ProbeLight> as_probes(std::span<const GatheredLight> gathered) {
  std::vector<ProbeLight> light;
  for (const GatheredLight& sample : gathered) light.push_back({sample.light, sample.error});
  return light;
}

std::vector<ProbeLight> smoothed(std::span<const std::uint8_t> separate, int parts, std::vector<GatheredLight> light) {
  std::vector<Neighbours> pairs;
  for_each_pair(parts, [&](int i, int j, int k, int l) {
    const auto here = static_cast<std::uint32_t>(TriangleGrid::index(parts, i, j));
    const auto other = static_cast<std::uint32_t>(TriangleGrid::index(parts, k, l));
    if (separate.empty() || (separate[here] == 0 && separate[other] == 0)) pairs.push_back({here, other, 1.0f});
  });
  smooth(pairs, light);
  return as_probes(light);
}

void refine(MadeGrid* grid) {
  const int parts = 2 * grid->parts;
  const auto count = static_cast<std::size_t>(TriangleGrid::samples(parts));
  std::vector<ProbeLight> light(count);
  std::vector<std::uint8_t> separate(count, 0);
  for_each_sample(grid->parts, [&](int i, int j) {
    const auto old = static_cast<std::size_t>(TriangleGrid::index(grid->parts, i, j));
    const auto here = static_cast<std::size_t>(TriangleGrid::index(parts, 2 * i, 2 * j));
    light[here] = grid->light[old];
    separate[here] = grid->separate[old];
  });
  for_each_pair(grid->parts, [&](int i, int j, int k, int l) {
    const auto a = static_cast<std::size_t>(TriangleGrid::index(grid->parts, i, j));
    const auto b = static_cast<std::size_t>(TriangleGrid::index(grid->parts, k, l));
    const auto between = static_cast<std::size_t>(TriangleGrid::index(parts, i + k, j + l));
    light[between] = mean(grid->light[a], grid->light[b]);
    separate[between] = grid->separate[a] | grid->separate[b];
  });
  grid->parts = parts;
  grid->light = std::move(light);
  grid->separate = std::move(separate);
}

void add(int parts, const std::vector<ProbeLight>& coarse, MadeGrid* grid) {
  std::size_t index = 0;
  const float scale = static_cast<float>(parts) / static_cast<float>(grid->parts);
  for_each_sample(grid->parts, [&](int i, int j) {
    ProbeLight& sample = grid->light[index++];
    const ProbeLight more = interpolated(coarse, parts, static_cast<float>(i) * scale, static_cast<float>(j) * scale);
    sample.light += more.light;
    sample.error = std::hypot(sample.error, more.error);
  });
}

}  // namespace cyclorama::light_baking
