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

class Smoother {
 public:
  Smoother(const render::SurfaceMesh& mesh, BaseSide& side) : side_(side) {
    for (std::size_t t = 0; t < mesh.triangle_count; ++t) {
      const std::array<std::uint32_t, 3>& c = mesh.triangles[t];
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t a = c[i];
        const std::uint32_t b = c[(i + 1) % 3];
        if (!counts(a) || !counts(b)) continue;
        const float weight = agreement(side_.points[a], side_.points[b]);
        if (weight > 0.0f) edges_.push_back({a, b, weight});
      }
    }
  }

  void run() {
    const std::size_t count = side_.points.size();
    std::vector<GatheredLight> raw(count);
    for (std::size_t i = 0; i < count; ++i) raw[i] = side_.light[i].surfaces;
    const std::vector<GatheredLight> smooth = mean(mean(raw));
    std::vector<float> difference(count);
    std::vector<float> noise(count);
    for (std::size_t i = 0; i < count; ++i) {
      const float d = render::luminance(raw[i].light - smooth[i].light);
      difference[i] = d * d;
      noise[i] = kDifferenceVariance * raw[i].error * raw[i].error;
    }
    difference = mean(difference);
    noise = mean(noise);
    for (std::size_t i = 0; i < count; ++i) {
      if (!counts(static_cast<std::uint32_t>(i))) continue;
      const float signal = difference[i] > noise[i] ? 1.0f - noise[i] / difference[i] : 0.0f;
      GatheredLight& out = side_.light[i].surfaces;
      out.light = smooth[i].light + signal * (raw[i].light - smooth[i].light);
      out.direction = smooth[i].direction + signal * (raw[i].direction - smooth[i].direction);
      out.error = raw[i].error * std::sqrt(signal * signal + (1.0f - signal) * (1.0f - signal) * kLeftVariance);
    }
  }

 private:
  struct Edge {
    std::uint32_t a, b;
    float weight;
  };

  [[nodiscard]] bool counts(std::uint32_t i) const { return side_.seen[i] == Seen::kYes && side_.points[i].exists(); }

  static void add(float weight, const GatheredLight& light, GatheredLight* sum) {
    sum->light += weight * light.light;
    sum->direction += weight * light.direction;
    sum->error += weight * light.error;
  }
  static void add(float weight, float value, float* sum) { *sum += weight * value; }
  static void scale(float factor, GatheredLight* value) {
    value->light *= factor;
    value->direction *= factor;
    value->error *= factor;
  }
  static void scale(float factor, float* value) { *value *= factor; }

  /// Returns the mean over each sample and its neighbours. An edge inside the surface occurs twice, so it has half
  /// weight.
  template <typename Value>
  [[nodiscard]] std::vector<Value> mean(const std::vector<Value>& values) const {
    std::vector<Value> sum = values;
    std::vector<float> weight(values.size(), 1.0f);
    for (const Edge& edge : edges_) {
      const float half = 0.5f * edge.weight;
      add(half, values[edge.a], &sum[edge.b]);
      add(half, values[edge.b], &sum[edge.a]);
      weight[edge.a] += half;
      weight[edge.b] += half;
    }
    for (std::size_t i = 0; i < sum.size(); ++i) scale(1.0f / weight[i], &sum[i]);
    return sum;
  }

  BaseSide& side_;
  std::vector<Edge> edges_;
};

}  // namespace

void smooth_gathered_light(const render::SurfaceMesh& mesh, BaseSide* side) {
  if (!side->per_triangle) Smoother(mesh, *side).run();
}

}  // namespace cyclorama::light_baking
