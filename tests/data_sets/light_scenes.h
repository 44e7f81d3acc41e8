// SPDX-License-Identifier: Apache-2.0
/// Scenes for tests and benchmarks of stored light: boxes, floors that are not flat, and the comparison of pictures
/// with traced ones.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "common/image/colour.h"
#include "renderfarm/quality/split_reference.h"
#include "renderfarm/render/sampler.h"
#include "renderfarm/render/tone.h"
#include "tests/data_sets/simple_scenes.h"

namespace cyclorama {

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

inline constexpr double kFloorSpan = 4.0;

/// Returns a fixed random number in [-0.3, 0.3).
inline double displacement(int column, int row, int axis) {
  const auto key = static_cast<std::uint32_t>(2 * (1000 * row + column) + axis);
  return 0.6 * static_cast<double>(render::to_unit_float(render::mix_bits(key))) - 0.3;
}

/// A floor of 4 m whose height is `height(x, z)`, cut into `pieces` x `pieces` meshes that share no vertices, as
/// exporters cut at seams of textures. Each piece has `parts` x `parts` squares, whose corners are displaced at random,
/// as those of scans are.
inline void add_floor(scene::Scene& scene, int pieces, int parts, const std::function<double(double, double)>& height) {
  constexpr double kStep = 1e-4;
  const int total = pieces * parts;
  for (int pz = 0; pz < pieces; ++pz) {
    for (int px = 0; px < pieces; ++px) {
      scene::Mesh mesh;
      for (int j = 0; j <= parts; ++j) {
        for (int i = 0; i <= parts; ++i) {
          const int column = px * parts + i;
          const int row = pz * parts + j;
          const double x = kFloorSpan * ((column + displacement(column, row, 0)) / total - 0.5);
          const double z = kFloorSpan * ((row + displacement(column, row, 1)) / total - 0.5);
          const Eigen::Vector3d normal = Eigen::Vector3d(height(x - kStep, z) - height(x + kStep, z), 2.0 * kStep,
                                                         height(x, z - kStep) - height(x, z + kStep))
                                             .normalized();
          mesh.positions.push_back({static_cast<float>(x), static_cast<float>(height(x, z)), static_cast<float>(z)});
          mesh.normals.push_back(
              {static_cast<float>(normal.x()), static_cast<float>(normal.y()), static_cast<float>(normal.z())});
        }
      }
      const auto vertices = static_cast<std::uint32_t>(parts + 1);
      for (std::uint32_t j = 0; j + 1 < vertices; ++j) {
        for (std::uint32_t i = 0; i + 1 < vertices; ++i) {
          const std::uint32_t a = j * vertices + i;
          mesh.triangles.push_back({a, a + vertices, a + 1});
          mesh.triangles.push_back({a + 1, a + vertices, a + vertices + 1});
        }
      }
      add_mesh(scene, std::move(mesh));
    }
  }
}

inline double waves(double x, double z) { return 0.12 * std::sin(5.0 * x) * std::cos(4.0 * z) - 1.0; }
inline double furrows(double x, double) { return 0.05 * std::sin(9.0 * x) - 1.0; }
inline double bowl(double x, double z) { return 0.25 * (x * x + z * z) - 1.3; }

inline scene::Scene lit_floor(int pieces, int parts, const std::function<double(double, double)>& height) {
  scene::Scene scene;
  scene.model.materials.push_back(matte_material(Eigen::Vector3f::Constant(0.5f)));
  add_floor(scene, pieces, parts, height);
  scene.model.lights = {point_light({1.1, 0.6, 0.4}, 4.0f)};
  scene.model.lights[0].radius_m = 0.15;
  scene.exposure = 0.5;
  scene.info.start_eye = {-0.4, 0.4, 0.7};
  return scene;
}

struct LightDifference {
  double relative_bias = 0.0;
  double worst_codes = 0.0;  ///< Largest difference of an 8x8 block's mean, in display codes.
  int blocks = 0;            ///< Blocks that were compared, and those that are off by more than kMaxCodes.
  int bad_blocks = 0;
};

/// Difference of a block that a visitor might notice.
inline constexpr double kMaxCodes = 4.0;

/// Compares pictures with stored light to converged ones. Blocks are averaged before they are tone mapped: the mean of
/// the codes of noisy pixels would be too dark.
inline LightDifference light_difference(const render::Renderer& renderer, render::PanoramaView view,
                                        int reference_samples) {
  view.quality.samples = 64;
  view.quality.bounces = renderer.scene().bounces;
  view.quality.stored_light = true;
  const RadianceImage stored = radiance_of(renderer, view);
  view.quality.stored_light = false;
  view.quality.samples = reference_samples;
  view.seed = 77;
  const RadianceImage reference = radiance_of(renderer, view);
  LightDifference result;
  result.relative_bias = mean_of(stored) / mean_of(reference) - 1.0;
  const RadianceImage blocks = quality::block_means(stored, 8);
  const RadianceImage reference_blocks = quality::block_means(reference, 8);
  const auto code = [&](float radiance) {
    return 255.0 * static_cast<double>(linear_to_srgb(render::tone_mapped(radiance, renderer.scene().tone)));
  };
  for (int y = 0; y < blocks.height(); ++y) {
    for (int x = 0; x < blocks.width(); ++x) {
      const double codes = std::abs(code(blocks.at(x, y)[1]) - code(reference_blocks.at(x, y)[1]));
      result.worst_codes = std::max(result.worst_codes, codes);
      ++result.blocks;
      if (codes > kMaxCodes) ++result.bad_blocks;
    }
  }
  return result;
}

}  // namespace cyclorama
