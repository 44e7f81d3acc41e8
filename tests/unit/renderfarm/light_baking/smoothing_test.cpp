// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light_baking/smoothing.h"

#include <gtest/gtest.h>

#include <random>

#include "renderfarm/render/trace_scene.h"

namespace cyclorama::light_baking {
namespace {

constexpr int kSide = 32;  ///< Vertices along an edge of the surface.

/// A level surface of which every vertex is seen.
struct Surface {
  std::vector<std::array<std::uint32_t, 3>> triangles{};
  render::SurfaceMesh mesh{};
  BaseSide side{};

  Surface() {
    for (std::uint32_t j = 0; j + 1 < kSide; ++j) {
      for (std::uint32_t i = 0; i + 1 < kSide; ++i) {
        const std::uint32_t a = j * kSide + i;
        triangles.push_back({a, a + kSide, a + 1});
        triangles.push_back({a + 1, a + kSide, a + kSide + 1});
      }
    }
    mesh.triangles = triangles.data();
    mesh.triangle_count = triangles.size();
    mesh.vertex_count = std::size_t{kSide} * kSide;
    side.points.resize(mesh.vertex_count);
    for (LightPoint& point : side.points) point.normal = render::Vec3::UnitY();
    side.light.resize(mesh.vertex_count);
    side.seen.assign(mesh.vertex_count, Seen::kYes);
  }
  [[nodiscard]] static std::size_t site(int i, int j) {
    return static_cast<std::size_t>(j) * kSide + static_cast<std::size_t>(i);
  }
  [[nodiscard]] GatheredLight& at(int i, int j) { return side.light[site(i, j)].surfaces; }
  /// Sets the light to truth(i) plus noise.
  template <typename Truth>
  void fill(float noise, const Truth& truth) {
    std::mt19937 random(5);
    std::normal_distribution<float> scatter(0.0f, noise > 0.0f ? noise : 1.0f);
    for (int j = 0; j < kSide; ++j) {
      for (int i = 0; i < kSide; ++i) {
        const float value = truth(i) + (noise > 0.0f ? scatter(random) : 0.0f);
        at(i, j) = {render::Vec3::Constant(value), render::Vec3::Zero(), noise};
      }
    }
  }
};

TEST(Smoothing, takes_most_noise_from_even_light) {
  Surface surface;
  surface.fill(0.1f, [](int) { return 1.0f; });
  smooth_gathered_light(surface.mesh, &surface.side);
  double squares = 0.0;
  for (int j = 2; j < kSide - 2; ++j) {
    for (int i = 2; i < kSide - 2; ++i) {
      const double error = static_cast<double>(surface.at(i, j).light.x()) - 1.0;
      squares += error * error / ((kSide - 4) * (kSide - 4));
    }
  }
  EXPECT_LT(squares, 0.25 * 0.1 * 0.1);
  EXPECT_LT(surface.at(9, 9).error, 0.09f);
}

TEST(Smoothing, keeps_an_edge_that_is_no_noise) {
  Surface surface;
  surface.fill(0.02f, [](int i) { return i < kSide / 2 ? 1.0f : 3.0f; });
  smooth_gathered_light(surface.mesh, &surface.side);
  EXPECT_NEAR(surface.at(kSide / 2 - 1, 9).light.x(), 1.0f, 0.1f);
  EXPECT_NEAR(surface.at(kSide / 2, 9).light.x(), 3.0f, 0.1f);
}

TEST(Smoothing, changes_nothing_that_has_no_error) {
  Surface surface;
  surface.fill(0.0f, [](int i) { return std::sin(static_cast<float>(i)); });
  smooth_gathered_light(surface.mesh, &surface.side);
  for (int i = 0; i < kSide; ++i) EXPECT_NEAR(surface.at(i, 9).light.x(), std::sin(static_cast<float>(i)), 1e-6f);
}

TEST(Smoothing, does_not_reach_over_a_fold_or_to_what_nobody_sees) {
  Surface surface;
  surface.fill(0.5f, [](int) { return 1.0f; });
  const auto middle = Surface::site(9, 9);
  const float before = surface.at(9, 9).light.x();
  surface.side.points[middle].normal = render::Vec3::UnitX();
  surface.side.seen[middle + 5] = Seen::kBeside;
  const float beside = surface.at(14, 9).light.x();
  smooth_gathered_light(surface.mesh, &surface.side);
  EXPECT_EQ(surface.at(9, 9).light.x(), before);
  EXPECT_EQ(surface.at(14, 9).light.x(), beside);
}

}  // namespace
}  // namespace cyclorama::light_baking
