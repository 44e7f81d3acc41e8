// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light/light_store.h"

#include <fmt/format.h>

#include <utility>

#include "renderfarm/light/mean_direction.h"

namespace cyclorama::light {
namespace {

const Eigen::Vector3f kLuminanceWeights(0.2126f, 0.7152f, 0.0722f);
constexpr float kDarkShare = 0.1f;

}  // namespace

std::optional<Eigen::Vector3f> LightStore::in_grid(const SideLight& light, std::uint32_t grid,
                                                   const Eigen::Vector3f& weights) const {
  if (grid == TriangleGrid::kTraced) return std::nullopt;
  const int parts = TriangleGrid::parts(grid);
  const auto scale = static_cast<float>(parts);
  const float u = std::clamp(weights[1], 0.0f, 1.0f) * scale;
  const float v = std::clamp(weights[2], 0.0f, 1.0f) * scale;
  const int j = std::min(static_cast<int>(v), parts - 1);
  const int i = std::min(static_cast<int>(u), parts - 1 - j);
  const float part_u = std::min(u - static_cast<float>(i), 1.0f);
  const float part_v = std::min(v - static_cast<float>(j), 1.0f);
  const auto sample = [&](int column, int row) {
    return light
        .samples[TriangleGrid::offset(grid) + static_cast<std::uint32_t>(TriangleGrid::index(parts, column, row))];
  };
  // Each part consists of two triangles, except the last part of a row, which is one.
  if (part_u + part_v <= 1.0f || i + j == parts - 1) {
    const float rest = std::max(0.0f, 1.0f - part_u - part_v);
    return mixed<3>({sample(i, j), sample(i + 1, j), sample(i, j + 1)}, {rest, part_u, part_v});
  }
  return mixed<3>({sample(i + 1, j + 1), sample(i, j + 1), sample(i + 1, j)},
                  {part_u + part_v - 1.0f, 1.0f - part_u, 1.0f - part_v});
}

Eigen::Vector3f LightStore::direction_at(const LightPlace& place) const {
  const SurfaceLight& surface = surfaces[place.placement];
  const SideLight& light = surface.sides[static_cast<std::size_t>(place.side)];
  if (light.directions.empty()) return Eigen::Vector3f::Zero();
  if (surface.base_per_triangle) return from_direction_code(light.directions[place.primitive]);
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (std::size_t i = 0; i < 3; ++i) {
    sum += place.weights[static_cast<Eigen::Index>(i)] * from_direction_code(light.directions[place.vertices[i]]);
  }
  return sum;
}

std::size_t LightStore::sample_count() const {
  std::size_t count = 0;
  for (const SurfaceLight& surface : surfaces) {
    for (const SideLight& side : surface.sides) count += side.base.size() + side.samples.size();
  }
  for (const LightStore& group : groups) count += group.sample_count();
  return count;
}

std::size_t LightStore::bytes() const {
  std::size_t bytes = surfaces.size() * sizeof(SurfaceLight);
  for (const SurfaceLight& surface : surfaces) {
    for (const SideLight& side : surface.sides) {
      bytes += (side.base.size() + side.samples.size()) * kSampleBytes;
      bytes += (side.grids.size() + side.directions.size()) * sizeof(std::uint32_t);
    }
  }
  for (const LightStore& group : groups) bytes += group.bytes();
  return bytes;
}

Percentiles LightStore::relative_errors() const {
  struct Sample {
    float luminance;
    float error;
  };
  std::vector<Sample> all;
  double sum = 0.0;
  const auto add = [&](const std::vector<std::uint32_t>& codes, const std::vector<std::uint8_t>& errors, float scale) {
    for (std::size_t i = 0; i < errors.size(); ++i) {
      if (codes[i] == kNoSample) continue;
      all.push_back({scale * from_rgb9e5(codes[i]).dot(kLuminanceWeights), scale * from_error_code(errors[i])});
      sum += static_cast<double>(all.back().luminance);
    }
  };
  const auto add_all = [&](const LightStore& store) {
    for (const SurfaceLight& surface : store.surfaces) {
      for (const SideLight& side : surface.sides) {
        add(side.base, side.base_errors, store.unit);
        add(side.samples, side.sample_errors, store.unit);
      }
    }
  };
  add_all(*this);
  for (const LightStore& group : groups) add_all(group);
  const float dark = all.empty() ? 0.0f : kDarkShare * static_cast<float>(sum / static_cast<double>(all.size()));
  std::vector<float> errors;
  for (const Sample& sample : all) {
    if (sample.luminance > dark) errors.push_back(sample.error / sample.luminance);
  }
  return percentiles_of(std::move(errors));
}

std::string description_of(const LightStore& store) {
  const Percentiles errors = store.relative_errors();
  std::string text = fmt::format("standard error of a sample: {:.1f} % (median), {:.1f} % (95 %)", 100.0f * errors.p50,
                                 100.0f * errors.p95);
  const LightCheck& check = store.check;
  if (check.eyes == 0) return text + "; not compared with path tracing";
  text += fmt::format(
      "; from {} held-out eyes: relMSE {:.2g} (median), {:.2g} (95 %), {:.2g} (99 %), of 8x8 pixels {:.2g}, {:.2g}, "
      "{:.2g}; FLIP {:.3f}, {:.3f}, {:.3f}; bias {:+.2f} %; worst from ({:.2f}, {:.2f}, {:.2f}): {:.1f} codes",
      check.eyes, check.relmse.p50, check.relmse.p95, check.relmse.p99, check.block_relmse.p50, check.block_relmse.p95,
      check.block_relmse.p99, check.flip.p50, check.flip.p95, check.flip.p99, 100.0f * check.bias, check.worst_eye[0],
      check.worst_eye[1], check.worst_eye[2], check.worst_codes);
  if (check.loses_to_paths()) text += "; path tracing at the same cost is better, so this light does not pay";
  return text;
}

}  // namespace cyclorama::light
