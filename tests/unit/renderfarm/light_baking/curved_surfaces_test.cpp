// SPDX-License-Identifier: Apache-2.0
// Stored light on surfaces that are not flat: at their vertices they hide parts of themselves.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <utility>

#include "renderfarm/render/sampler.h"
#include "tests/unit/renderfarm/light_baking/light_cases.h"

namespace cyclorama::light_baking {
namespace {

constexpr double kSpan = 4.0;

/// Returns a fixed random number in [-0.3, 0.3).
double displacement(int column, int row, int axis) {
  const auto key = static_cast<std::uint32_t>(2 * (1000 * row + column) + axis);
  return 0.6 * static_cast<double>(render::to_unit_float(render::mix_bits(key))) - 0.3;
}

/// A floor of 4 m whose height is `height(x, z)`, cut into `pieces` x `pieces` meshes that share no vertices, as
/// exporters cut at seams of textures. Each piece has `parts` x `parts` squares, whose corners are displaced at random,
/// as those of scans are.
void add_floor(scene::Scene& scene, int pieces, int parts, const std::function<double(double, double)>& height) {
  constexpr double kStep = 1e-4;
  const int total = pieces * parts;
  for (int pz = 0; pz < pieces; ++pz) {
    for (int px = 0; px < pieces; ++px) {
      scene::Mesh mesh;
      for (int j = 0; j <= parts; ++j) {
        for (int i = 0; i <= parts; ++i) {
          const int column = px * parts + i;
          const int row = pz * parts + j;
          const double x = kSpan * ((column + displacement(column, row, 0)) / total - 0.5);
          const double z = kSpan * ((row + displacement(column, row, 1)) / total - 0.5);
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

double waves(double x, double z) { return 0.12 * std::sin(5.0 * x) * std::cos(4.0 * z) - 1.0; }
double furrows(double x, double) { return 0.05 * std::sin(9.0 * x) - 1.0; }
double bowl(double x, double z) { return 0.25 * (x * x + z * z) - 1.3; }

scene::Scene lit_floor(int pieces, int parts, const std::function<double(double, double)>& height) {
  scene::Scene scene;
  scene.model.materials.push_back(matte_material(Eigen::Vector3f::Constant(0.5f)));
  add_floor(scene, pieces, parts, height);
  scene.model.lights = {point_light({1.1, 0.6, 0.4}, 4.0f)};
  scene.model.lights[0].radius_m = 0.15;
  scene.exposure = 0.5;
  scene.info.start_eye = {-0.4, 0.4, 0.7};
  return scene;
}

Difference of_floor(scene::Scene scene) {
  const auto renderer = built(std::move(scene));
  baked(*renderer);
  // Downwards, where the floor is.
  return difference(*renderer, view_from({-0.4, 0.4, 0.7}, 128, 64, 0.1, -2.5), 128);
}

TEST(CurvedSurfaces, have_no_stripes_whether_whole_or_in_pieces) {
  for (const auto& [name, height] :
       {std::pair{"waves", &waves}, std::pair{"furrows", &furrows}, std::pair{"bowl", &bowl}}) {
    for (const int pieces : {1, 8}) {
      const Difference found = of_floor(lit_floor(pieces, 32 / pieces, height));
      EXPECT_LT(std::abs(found.relative_bias), 0.01) << name << " in " << pieces;
      EXPECT_LT(found.worst_codes, 4.0) << name << " in " << pieces;
    }
  }
}

}  // namespace
}  // namespace cyclorama::light_baking
