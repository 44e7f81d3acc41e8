// SPDX-License-Identifier: Apache-2.0
/// What the tests of computed light share: quick settings, a box, and the comparison with traced paths.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "common/image/image.h"
#include "renderfarm/light_baking/bake_light.h"
#include "tests/data_sets/simple_scenes.h"

namespace cyclorama::light_baking {

inline BakeSettings quick() {
  BakeSettings settings;
  settings.eyes = 4;
  settings.rays_per_eye = 1 << 13;
  settings.pixels_per_degree = 2.0;
  return settings;
}

inline std::unique_ptr<render::Renderer> built(scene::Scene scene) {
  auto renderer = render::Renderer::build(std::move(scene), 2, nullptr);
  EXPECT_TRUE(renderer.has_value()) << renderer.error().message();
  return *std::move(renderer);
}

inline BakedLight baked(render::Renderer& renderer, const BakeSettings& settings = quick(), int threads = 2) {
  auto result = bake_light(renderer, settings, threads, nullptr, nullptr);
  EXPECT_TRUE(result.has_value()) << result.error().message();
  return *std::move(result);
}

/// A box about the eye, each side of 4 m, from the inside.
inline scene::Scene box_scene(float albedo, int parts) {
  scene::Scene scene;
  scene.model.materials.push_back(matte_material(Eigen::Vector3f::Constant(albedo)));
  const Eigen::Vector3d axes[3] = {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()};
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-2.0, 2.0}) {
      scene::Mesh mesh;
      const Eigen::Vector3d u = axes[(axis + 1) % 3];
      const Eigen::Vector3d v = axes[(axis + 2) % 3];
      for (int j = 0; j <= parts; ++j) {
        for (int i = 0; i <= parts; ++i) {
          const Eigen::Vector3d p = side * axes[axis] + (4.0 * i / parts - 2.0) * u + (4.0 * j / parts - 2.0) * v;
          mesh.positions.push_back({static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())});
          const Eigen::Vector3d n = axes[axis] * (side > 0.0 ? -1.0 : 1.0);
          mesh.normals.push_back({static_cast<float>(n.x()), static_cast<float>(n.y()), static_cast<float>(n.z())});
        }
      }
      const auto row = static_cast<std::uint32_t>(parts + 1);
      for (std::uint32_t j = 0; j + 1 < row; ++j) {
        for (std::uint32_t i = 0; i + 1 < row; ++i) {
          const std::uint32_t a = j * row + i;
          if (side > 0.0) {
            mesh.triangles.push_back({a, a + row, a + 1});
            mesh.triangles.push_back({a + 1, a + row, a + row + 1});
          } else {
            mesh.triangles.push_back({a, a + 1, a + row});
            mesh.triangles.push_back({a + 1, a + row + 1, a + row});
          }
        }
      }
      add_mesh(scene, std::move(mesh));
    }
  }
  scene.info.start_eye = {0.3, 0.2, -0.1};
  return scene;
}

struct Difference {
  double relative_bias = 0.0;
  double worst_codes = 0.0;  ///< Largest difference of an 8x8 block's mean, in display codes.
};

/// Compares pictures with stored light to converged ones.
inline Difference difference(const render::Renderer& renderer, render::PanoramaView view, int reference_samples) {
  view.quality.samples = 16;
  view.quality.bounces = renderer.scene().bounces;
  view.quality.stored_light = true;
  RgbImage shown;
  renderer.render(view, whole(view), &shown, nullptr);
  const RadianceImage stored = radiance_of(renderer, view);
  view.quality.stored_light = false;
  view.quality.samples = reference_samples;
  view.seed = 77;
  RgbImage reference_shown;
  renderer.render(view, whole(view), &reference_shown, nullptr);
  const RadianceImage reference = radiance_of(renderer, view);
  Difference result;
  result.relative_bias = mean_of(stored) / mean_of(reference) - 1.0;
  for (int by = 0; by + 8 <= shown.height(); by += 8) {
    for (int bx = 0; bx + 8 <= shown.width(); bx += 8) {
      double sum = 0.0;
      for (int y = by; y < by + 8; ++y) {
        for (int x = bx; x < bx + 8; ++x) sum += shown.at(x, y)[1] - reference_shown.at(x, y)[1];
      }
      result.worst_codes = std::max(result.worst_codes, std::abs(sum) / 64.0);
    }
  }
  return result;
}

}  // namespace cyclorama::light_baking
