// SPDX-License-Identifier: Apache-2.0
/// The mean direction of the light at a sample, for surfaces with a normal map.
///
/// The model: a share |d| of the light comes from the direction of d, and the rest evenly from all directions. The
/// irradiance for a bent normal is the irradiance for the surface's normal times
///
///     1 - |d| + |d| (bent . d) / (normal . d)
///
/// Source: Hable and others, directional lightmaps with a dominant direction, as in Unity and Enlighten.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>

namespace cyclorama::light {

/// Encodes a vector of length up to 1 in 32 bits: 12 bits for each octahedral coordinate and 8 bits for the length.
/// Source: Cigolle et al., "A Survey of Efficient Representations for Independent Unit Vectors", JCGT 3(2), 2014.
[[nodiscard]] inline std::uint32_t to_direction_code(const Eigen::Vector3f& mean) {
  const float length = mean.norm();
  if (!(length > 0.0f) || !std::isfinite(length)) return 0;
  const Eigen::Vector3f n = mean / mean.cwiseAbs().sum();
  float x = n.x();
  float y = n.y();
  if (n.z() < 0.0f) {
    x = std::copysign(1.0f - std::abs(n.y()), n.x());
    y = std::copysign(1.0f - std::abs(n.x()), n.y());
  }
  const auto part = [](float value) {
    return static_cast<std::uint32_t>(std::lround((0.5f * value + 0.5f) * 4095.0f));
  };
  return part(x) | part(y) << 12 | static_cast<std::uint32_t>(std::lround(std::min(length, 1.0f) * 255.0f)) << 24;
}

[[nodiscard]] inline Eigen::Vector3f from_direction_code(std::uint32_t code) {
  const auto part = [](std::uint32_t bits) { return static_cast<float>(bits & 4095u) * (2.0f / 4095.0f) - 1.0f; };
  float x = part(code);
  float y = part(code >> 12);
  const float z = 1.0f - std::abs(x) - std::abs(y);
  if (z < 0.0f) {
    const float folded = std::copysign(1.0f - std::abs(y), x);
    y = std::copysign(1.0f - std::abs(x), y);
    x = folded;
  }
  return Eigen::Vector3f(x, y, z).normalized() * (static_cast<float>(code >> 24) * (1.0f / 255.0f));
}

/// Returns the factor on the irradiance for a bent normal. All vectors are in one frame; the normals have unit length.
[[nodiscard]] inline float bent_share(const Eigen::Vector3f& mean, const Eigen::Vector3f& normal,
                                      const Eigen::Vector3f& bent) {
  /// Bounds for grazing light, which would otherwise make bumps arbitrarily bright.
  constexpr float kMinCosine = 0.15f;
  constexpr float kMaxShare = 4.0f;
  const float directed = mean.norm();
  if (!(directed > 0.0f)) return 1.0f;
  const Eigen::Vector3f direction = mean / directed;
  const float ratio = std::max(0.0f, bent.dot(direction)) / std::max(kMinCosine, normal.dot(direction));
  return std::clamp(1.0f - directed + directed * ratio, 0.0f, kMaxShare);
}

}  // namespace cyclorama::light
