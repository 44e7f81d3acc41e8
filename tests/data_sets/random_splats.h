// SPDX-License-Identifier: Apache-2.0
/// Splats at random, and what a ray sees of them in double, straight from the equations.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "renderfarm/render/splats/splat_harmonics.h"
#include "renderfarm/scene/splat_cloud.h"

namespace cyclorama {

struct RandomSplats {
  int count = 100;
  int degree = 3;
  double min_scale = 0.02;
  double max_scale = 0.4;
  double half_width = 1.0;  ///< Half the width of the cube about the origin in which they lie.
};

inline scene::SplatCloud random_splats(const RandomSplats& wanted, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-wanted.half_width, wanted.half_width);
  std::uniform_real_distribution<double> scale(std::log(wanted.min_scale), std::log(wanted.max_scale));
  std::uniform_real_distribution<double> opacity(0.02, 1.0);
  std::normal_distribution<double> normal;
  scene::SplatCloud cloud;
  cloud.degree = wanted.degree;
  std::vector<std::array<float, 3>> coefficients(cloud.coefficient_count());
  for (int i = 0; i < wanted.count; ++i) {
    scene::SplatValues values;
    values.position = {place(random), place(random), place(random)};
    values.scale = {std::exp(scale(random)), std::exp(scale(random)), std::exp(scale(random))};
    values.rotation = Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random));
    values.opacity = opacity(random);
    for (std::size_t k = 0; k < coefficients.size(); ++k) {
      for (float& channel : coefficients[k]) channel = static_cast<float>((k == 0 ? 1.0 : 0.3) * normal(random));
    }
    scene::add_splat(values, coefficients, &cloud);
  }
  return cloud;
}

struct SplatView {
  Eigen::Vector3d colour = Eigen::Vector3d::Zero();
  double transmittance = 1.0;
};

/// One splat as the equations have it.
struct ExactSplat {
  Eigen::Vector3d centre;
  Eigen::Matrix3d covariance;
  double opacity;
  std::size_t index;
};

inline std::vector<ExactSplat> exact_splats(const scene::SplatCloud& cloud) {
  std::vector<ExactSplat> splats;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const auto& q = cloud.rotations[i];
    const Eigen::Matrix3d turn =
        Eigen::Quaternionf(q[0], q[1], q[2], q[3]).cast<double>().normalized().toRotationMatrix();
    const Eigen::Vector3d scale = Eigen::Vector3f(cloud.scales[i].data()).cast<double>();
    const Eigen::Matrix3d axes = cloud.T_model_cloud.linear() * turn * scale.asDiagonal();
    const Eigen::Vector3d p = cloud.origin + Eigen::Vector3f(cloud.positions[i].data()).cast<double>();
    splats.push_back({cloud.T_model_cloud * p, axes * axes.transpose(), double{cloud.opacities[i]}, i});
  }
  return splats;
}

inline Eigen::Vector3d exact_colour(const scene::SplatCloud& cloud, const ExactSplat& splat,
                                    const Eigen::Vector3d& eye) {
  const Eigen::Vector3d d = (cloud.T_model_cloud.linear().inverse() * (splat.centre - eye)).normalized();
  const auto harmonics = render::splat_harmonics(d.x(), d.y(), d.z(), cloud.coefficient_count());
  Eigen::Vector3d colour = Eigen::Vector3d::Constant(0.5);
  for (std::size_t k = 0; k < cloud.coefficient_count(); ++k) {
    const auto& rgb = cloud.coefficients[splat.index * cloud.coefficient_count() + k];
    colour += harmonics[k] * Eigen::Vector3f(rgb.data()).cast<double>();
  }
  return colour.cwiseMax(0.0);
}

/// Blends (order, alpha, splat) as the original program does.
inline SplatView blended(const scene::SplatCloud& cloud, const std::vector<ExactSplat>& splats,
                         const Eigen::Vector3d& eye, std::vector<std::tuple<double, double, std::size_t>> met) {
  std::sort(met.begin(), met.end());
  SplatView view;
  for (const auto& [order, alpha, splat] : met) {
    if (view.transmittance * (1.0 - alpha) < 1e-4) break;
    view.colour += view.transmittance * alpha * exact_colour(cloud, splats[splat], eye);
    view.transmittance *= 1.0 - alpha;
  }
  return view;
}

/// Returns what a ray sees, by the density along it.
inline SplatView exact_view(const scene::SplatCloud& cloud, const std::vector<ExactSplat>& splats,
                            const Eigen::Vector3d& eye, const Eigen::Vector3d& direction, double far_m) {
  std::vector<std::tuple<double, double, std::size_t>> met;
  for (std::size_t i = 0; i < splats.size(); ++i) {
    const Eigen::Matrix3d precision = splats[i].covariance.inverse();
    const Eigen::Vector3d to = splats[i].centre - eye;
    const double t = direction.dot(precision * to) / direction.dot(precision * direction);
    const Eigen::Vector3d offset = to - t * direction;
    const double alpha = std::min(0.99, splats[i].opacity * std::exp(-0.5 * offset.dot(precision * offset)));
    if (alpha >= 1.0 / 255.0 && t > 0.0 && t < far_m) met.emplace_back(t, alpha, i);
  }
  return blended(cloud, splats, eye, std::move(met));
}

/// Returns what the original rasteriser shows along a direction: each splat is projected by the derivative of the
/// projection at its centre, for a camera at `eye` that looks along -z, and splats are ordered by depth. Without the
/// widening by 0.3 pixels, which stands for a pixel's size.
inline SplatView rasterised_view(const scene::SplatCloud& cloud, const std::vector<ExactSplat>& splats,
                                 const Eigen::Vector3d& eye, const Eigen::Vector3d& direction) {
  const Eigen::Vector2d pixel(direction.x() / -direction.z(), direction.y() / -direction.z());
  std::vector<std::tuple<double, double, std::size_t>> met;
  for (std::size_t i = 0; i < splats.size(); ++i) {
    const Eigen::Vector3d p = splats[i].centre - eye;
    const double depth = -p.z();
    if (depth < 0.2) continue;
    Eigen::Matrix<double, 2, 3> jacobian;
    jacobian << 1.0 / depth, 0.0, p.x() / (depth * depth), 0.0, 1.0 / depth, p.y() / (depth * depth);
    const Eigen::Matrix2d flat = jacobian * splats[i].covariance * jacobian.transpose();
    const Eigen::Vector2d offset = pixel - Eigen::Vector2d(p.x(), p.y()) / depth;
    const double alpha = std::min(0.99, splats[i].opacity * std::exp(-0.5 * offset.dot(flat.inverse() * offset)));
    if (alpha >= 1.0 / 255.0) met.emplace_back(depth, alpha, i);
  }
  return blended(cloud, splats, eye, std::move(met));
}

}  // namespace cyclorama
