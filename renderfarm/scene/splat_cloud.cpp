// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/splat_cloud.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "renderfarm/scene/mesh_repair.h"
#include "renderfarm/scene/model.h"
#include "renderfarm/scene/point_squares.h"

namespace cyclorama::scene {
namespace {

constexpr double kMinScale = 1e-12;
constexpr double kMinOpacity = 1.0 / 255.0;  ///< The original program leaves out fainter splats.

Eigen::Vector3d place_of(const SplatCloud& cloud, std::size_t splat) {
  const std::array<float, 3>& p = cloud.positions[splat];
  return cloud.T_model_cloud * (cloud.origin + Eigen::Vector3f(p[0], p[1], p[2]).cast<double>());
}

}  // namespace

std::size_t bytes_per_splat(int degree) {
  const auto coefficients = static_cast<std::size_t>((degree + 1) * (degree + 1));
  return sizeof(float) * (3 + 3 + 4 + 1 + 3 * coefficients);
}

std::size_t SplatCloud::memory_bytes() const { return size() * bytes_per_splat(degree); }

bool add_splat(const SplatValues& values, std::span<const std::array<float, 3>> coefficients, SplatCloud* cloud) {
  const double norm = values.rotation.norm();
  const bool is_finite = is_usable(values.position) && is_usable(values.scale) && std::isfinite(norm) &&
                         std::all_of(coefficients.begin(), coefficients.end(), [](const std::array<float, 3>& rgb) {
                           return std::abs(rgb[0]) < 1e6f && std::abs(rgb[1]) < 1e6f && std::abs(rgb[2]) < 1e6f;
                         });
  if (!is_finite || !(values.scale.minCoeff() >= 0.0) || !(norm > 1e-6) || !(values.opacity >= kMinOpacity))
    return false;
  if (cloud->positions.empty()) cloud->origin = origin_near(values.position);
  const Eigen::Vector3f p = (values.position - cloud->origin).cast<float>();
  const Eigen::Vector3f s = values.scale.cwiseMax(kMinScale).cast<float>();
  const Eigen::Quaternionf q = values.rotation.normalized().cast<float>();
  cloud->positions.push_back({p.x(), p.y(), p.z()});
  cloud->scales.push_back({s.x(), s.y(), s.z()});
  cloud->rotations.push_back({q.w(), q.x(), q.y(), q.z()});
  cloud->opacities.push_back(static_cast<float>(std::min(values.opacity, 1.0)));
  cloud->coefficients.insert(cloud->coefficients.end(), coefficients.begin(), coefficients.end());
  return true;
}

std::string note_of_left_out(std::size_t left_out) {
  if (left_out == 0) return "";
  return fmt::format("{} splats are invisible or have numbers that mean nothing: left out", left_out);
}

Eigen::AlignedBox3d bounds_of(const SplatCloud& cloud) {
  constexpr std::size_t kSamples = 200'000;
  constexpr double kStray = 0.005;
  constexpr double kReach = 2.0;  // In standard deviations; farther out, a splat is faint.
  Eigen::AlignedBox3d box;
  const std::size_t step = std::max<std::size_t>(1, cloud.size() / kSamples);
  const double scale = std::cbrt(std::abs(cloud.T_model_cloud.linear().determinant()));
  std::array<std::vector<double>, 3> low;
  std::array<std::vector<double>, 3> high;
  for (std::size_t i = 0; i < cloud.size(); i += step) {
    const Eigen::Vector3d p = place_of(cloud, i);
    const double reach = kReach * scale * double{*std::max_element(cloud.scales[i].begin(), cloud.scales[i].end())};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis].push_back(p[static_cast<int>(axis)] - reach);
      high[axis].push_back(p[static_cast<int>(axis)] + reach);
    }
  }
  if (low[0].empty()) return box;
  const auto stray = static_cast<std::ptrdiff_t>(kStray * static_cast<double>(low[0].size()));
  Eigen::Vector3d min;
  Eigen::Vector3d max;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::nth_element(low[axis].begin(), low[axis].begin() + stray, low[axis].end());
    std::nth_element(high[axis].begin(), high[axis].end() - 1 - stray, high[axis].end());
    min[static_cast<int>(axis)] = *(low[axis].begin() + stray);
    max[static_cast<int>(axis)] = *(high[axis].end() - 1 - stray);
  }
  box.extend(min);
  box.extend(max);
  return box;
}

Mesh shape_of(std::span<const SplatCloud> clouds) {
  constexpr std::size_t kSquares = 100'000;
  constexpr float kSolid = 0.3f;
  std::size_t all = 0;
  Eigen::AlignedBox3d box;
  for (const SplatCloud& cloud : clouds) {
    all += cloud.size();
    box.extend(bounds_of(cloud));
  }
  const std::size_t step = std::max<std::size_t>(1, all / kSquares);
  Mesh shape;
  if (box.isEmpty()) return shape;
  shape.origin = origin_near(box.center());
  for (const SplatCloud& cloud : clouds) {
    for (std::size_t i = 0; i < cloud.size(); i += step) {
      const Eigen::Vector3d p = place_of(cloud, i);
      if (cloud.opacities[i] < kSolid || !box.contains(p)) continue;
      const Eigen::Vector3f near_origin = (p - shape.origin).cast<float>();
      shape.positions.push_back({near_origin.x(), near_origin.y(), near_origin.z()});
    }
  }
  if (!shape.positions.empty()) make_point_squares(&shape);
  return shape;
}

}  // namespace cyclorama::scene
