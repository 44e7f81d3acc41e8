// SPDX-License-Identifier: Apache-2.0
/// Irradiance at a point, by sampling and in closed form.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "renderfarm/render/lights/light_sample.h"
#include "renderfarm/render/sampler.h"

namespace cyclorama {

/// Returns the mean of light times cosine over many samples of `sample(choice, u, &LightSample)`. Uses only the red
/// channel.
template <typename Sample>
[[nodiscard]] double sampled_irradiance(const Sample& sample, const render::Vec3& n, int samples = 1 << 14) {
  double sum = 0.0;
  for (int i = 0; i < samples; ++i) {
    const render::SampleSequence sequence(1, 0, 0, i, samples);
    render::LightSample aim;
    if (!sample(sequence.pair(1).x(), sequence.pair(0), &aim)) continue;
    EXPECT_NEAR(aim.direction.norm(), 1.0f, 1e-4f);
    EXPECT_TRUE(render::is_finite(aim.radiance_over_pdf));
    EXPECT_GE(aim.distance, 0.0f);
    sum += static_cast<double>(aim.radiance_over_pdf.x() * std::max(0.0f, n.dot(aim.direction)));
  }
  return sum / samples;
}

/// Returns the irradiance from a diffuse polygon of radiance 1 above the horizon. Source: Lambert, 1760.
[[nodiscard]] inline double polygon_irradiance(const std::vector<Eigen::Vector3d>& corners, const Eigen::Vector3d& n) {
  double sum = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector3d& a = corners[i];
    const Eigen::Vector3d& b = corners[(i + 1) % corners.size()];
    const Eigen::Vector3d edge = a.cross(b);
    if (!(edge.norm() > 0.0)) continue;
    sum += std::atan2(edge.norm(), a.dot(b)) * edge.normalized().dot(n);
  }
  return 0.5 * std::abs(sum);
}

}  // namespace cyclorama
