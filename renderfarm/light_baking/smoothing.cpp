// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light_baking/smoothing.h"

#include <algorithm>
#include <cmath>

namespace cyclorama::light_baking {
namespace {

using render::Vec3;

/// Cosines between normals from which a neighbour counts at all (45 degrees) and counts fully (18 degrees).
constexpr float kMinAgreement = 0.7f;
constexpr float kFullAgreement = 0.95f;
/// For a regular mesh: the fraction of a sample's variance that is left after two means over six neighbours and the
/// sample itself, and the fraction of the variance in the sample's difference from that mean.
constexpr float kLeftVariance = 0.08f;
constexpr float kDifferenceVariance = 0.8f;

float agreement(const LightPoint& a, const LightPoint& b) {
  return std::clamp((a.normal.dot(b.normal) - kMinAgreement) / (kFullAgreement - kMinAgreement), 0.0f, 1.0f);
}

void add(float weight, const GatheredLight& light, GatheredLight* sum) {
  sum->light += weight * light.light;
  sum->direction += weight * light.direction;
  sum->error += weight * light.error;
}
void add(float weight, float value, float* sum) { *sum += weight * value; }
void scale(float factor, GatheredLight* value) {
  value->light *= factor;
  value->direction *= factor;
  value->error *= factor;
}
void scale(float factor, float* value) { *value *= factor; }

/// Returns the means over each sample and its neighbours.
template <typename Value>
std::vector<Value> mean(std::span<const Neighbours> pairs, std::span<const Value> values) {
  std::vector<Value> sum(values.begin(), values.end());
  std::vector<float> weight(values.size(), 1.0f);
  for (const Neighbours& pair : pairs) {
    add(pair.weight, values[pair.a], &sum[pair.b]);
    add(pair.weight, values[pair.b], &sum[pair.a]);
    weight[pair.a] += pair.weight;
    weight[pair.b] += pair.weight;
  }
  for (std::size_t i = 0; i < sum.size(); ++i) scale(1.0f / weight[i], &sum[i]);
  return sum;
}
template <typename Value>
std::vector<Value> mean(std::span<const Neighbours> pairs, const std::vector<Value>& values) {
  return mean(pairs, std::span<const Value>(values));
}

}  // namespace

void smooth(std::span<const Neighbours> pairs, std::span<GatheredLight> light) {
  const std::size_t count = light.size();
  const std::vector<GatheredLight> smooth = mean(pairs, mean(pairs, std::span<const GatheredLight>(light)));
  std::vector<float> difference(count);
  std::vector<float> noise(count);
  std::vector<std::uint8_t> has_neighbours(count, 0);
  for (const Neighbours& pair : pairs) has_neighbours[pair.a] = has_neighbours[pair.b] = 1;
  for (std::size_t i = 0; i < count; ++i) {
    const float d = render::luminance(light[i].light - smooth[i].light);
    difference[i] = d * d;
    noise[i] = kDifferenceVariance * light[i].error * light[i].error;
  }
  difference = mean(pairs, difference);
  noise = mean(pairs, noise);
  for (std::size_t i = 0; i < count; ++i) {
    if (has_neighbours[i] == 0) continue;
    const float signal = difference[i] > noise[i] ? 1.0f - noise[i] / difference[i] : 0.0f;
    GatheredLight& out = light[i];
    out.light = smooth[i].light + signal * (out.light - smooth[i].light);
    out.direction = smooth[i].direction + signal * (out.direction - smooth[i].direction);
    out.error *= std::sqrt(signal * signal + (1.0f - signal) * (1.0f - signal) * kLeftVariance);
  }
}

void smooth_gathered_light(const render::SurfaceMesh& mesh, BaseSide* side) {
  if (side->per_triangle) return;
  const auto counts = [&](std::uint32_t i) { return side->seen[i] == Seen::kYes && side->points[i].exists(); };
  std::vector<Neighbours> pairs;
  for (std::size_t t = 0; t < mesh.triangle_count; ++t) {
    const std::array<std::uint32_t, 3>& c = mesh.triangles[t];
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = c[i];
      const std::uint32_t b = c[(i + 1) % 3];
      if (!counts(a) || !counts(b)) continue;
      const float weight = agreement(side->points[a], side->points[b]);
      // An edge inside the surface belongs to two triangles, hence the half.
      if (weight > 0.0f) pairs.push_back({a, b, 0.5f * weight});
    }
  }
  std::vector<GatheredLight> light(side->points.size());
  for (std::size_t i = 0; i < light.size(); ++i) light[i] = side->light[i].surfaces;
  smooth(pairs, light);
  for (std::size_t i = 0; i < light.size(); ++i) side->light[i].surfaces = light[i];
}

}  // namespace cyclorama::light_baking
