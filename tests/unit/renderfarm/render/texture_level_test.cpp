// SPDX-License-Identifier: Apache-2.0
// The texture level that a ray cone selects, and its effect on the picture.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <random>

#include "renderfarm/render/shading.h"
#include "renderfarm/render/surface.h"
#include "renderfarm/render/texture_lookup.h"
#include "tests/data_sets/simple_scenes.h"

namespace cyclorama::render {
namespace {

constexpr int kTexels = 256;

/// A square of side 1 under one picture of kTexels x kTexels, placed by `linear`.
struct Square {
  explicit Square(const Eigen::Matrix3d& linear = Eigen::Matrix3d::Identity()) {
    material.textures.emplace_back();
    material.textures[0].pixels = RgbaImage(kTexels, kTexels);
    use.texture = 0;
    mips = std::make_unique<MipTexture>(material.textures[0], TextureContent::kData);
    traced = trace_mesh(mesh);
    placement = place(traced, Eigen::Affine3d(linear));
  }
  [[nodiscard]] float lod(const Footprint& footprint, std::size_t triangle = 0) const {
    const TriangleHit hit{&traced, &placement, mesh.triangles[triangle], Vec3::Constant(1.0f / 3.0f), nullptr, {}};
    return lod_of(hit, use, *mips, footprint);
  }
  scene::Mesh mesh = square_mesh(1.0f);
  scene::Model material;
  scene::TextureUse use;
  std::unique_ptr<MipTexture> mips;
  SurfaceMesh traced;
  Placement placement;
};

TEST(TextureLevel, is_the_logarithm_of_the_footprint_in_texels) {
  const Square square;
  for (const float level : {0.0f, 1.0f, 2.5f, 8.0f}) {
    for (const std::size_t triangle : {0U, 1U}) {
      EXPECT_NEAR(square.lod({std::exp2(level) / kTexels, 1.0f}, triangle), level, 1e-4f);
    }
  }
  // At an oblique angle, the cone's footprint is longer.
  EXPECT_NEAR(square.lod({4.0f / kTexels, 0.25f}), 4.0f, 1e-4f);
}

TEST(TextureLevel, increases_with_distance_and_slant) {
  const Square square;
  float last = -std::numeric_limits<float>::infinity();
  for (float distance = 0.1f; distance < 1e5f; distance *= 1.3f) {
    const float lod = square.lod({0.001f * distance, 0.7f});
    EXPECT_GT(lod, last) << distance;
    last = lod;
  }
  for (float cosine = 1.0f; cosine > 1e-4f; cosine *= 0.8f) {
    EXPECT_GE(square.lod({0.01f, 0.8f * cosine}), square.lod({0.01f, cosine}));
  }
}

TEST(TextureLevel, is_independent_of_the_scenes_units) {
  const Square metres;
  for (const double scale : {1e-3, 1e-2, 1.0, 1e2, 1e3}) {
    const Square scaled(Eigen::Matrix3d::Identity() * scale);
    for (const float width : {1e-4f, 0.01f, 3.0f}) {
      EXPECT_NEAR(scaled.lod({width * static_cast<float>(scale), 0.6f}), metres.lod({width, 0.6f}), 1e-3f) << scale;
    }
  }
}

TEST(TextureLevel, accounts_for_the_textures_transform) {
  Square square;
  const float before = square.lod({0.1f, 1.0f});
  square.use.transform.leftCols<2>() *= 4.0f;
  EXPECT_NEAR(square.lod({0.1f, 1.0f}), before + 2.0f, 1e-4f);
}

TEST(TextureLevel, is_finest_without_a_width_and_defined_without_a_triangle) {
  Square square;
  EXPECT_EQ(square.lod({0.0f, 1.0f}), 0.0f);
  EXPECT_EQ(square.lod({std::numeric_limits<float>::quiet_NaN(), 1.0f}), 0.0f);
  square.mesh.texcoords[0].assign(4, {0.5f, 0.5f});
  EXPECT_FALSE(square.lod({0.1f, 1.0f}) > 0.0f);
  square.mesh.positions.assign(4, {1, 1, 1});
  for (const float cosine : {1.0f, 0.0f}) {
    const Eigen::Vector4f colour = lookup(*square.mips, {0.5f, 0.5f}, Coding::kLinear, square.lod({0.1f, cosine}));
    EXPECT_TRUE(colour.allFinite());
  }
}

/// A floor of 400 m with noisy tiles, seen at a grazing angle from eye height.
struct Floor {
  Floor() : scene(scene_of(square_mesh(kSide), Eigen::Vector3f::Ones())) {
    std::mt19937 random(5);
    scene::Texture noise;
    noise.pixels = RgbaImage(kTexels, kTexels, 255);
    for (int y = 0; y < kTexels; ++y) {
      for (int x = 0; x < kTexels; ++x) std::fill_n(noise.pixels.at(x, y), 3, (random() & 1U) != 0 ? 255 : 0);
    }
    scene.model.textures.push_back(std::move(noise));
    scene::TextureUse& use = scene.model.materials[0].base_colour_texture;
    use.texture = 0;
    use.transform.leftCols<2>() *= 64.0f;
    material = trace_material(scene.model, scene.model.materials[0], &textures);
    textures.build(1);
    mesh = trace_mesh(scene.model.meshes[0]);
    mesh.material = &material;
    placement.mesh = &mesh;
  }
  /// Returns the red seen through a position of the picture, in pixels of kPx radians; each sample covers `share` of
  /// one.
  [[nodiscard]] float red(float u, float v, float share) const {
    constexpr float kPx = 0.01f;
    const Vec3 eye(0.3f, 1.6f, 0.2f);
    const Vec3 direction = Vec3(std::sin(kPx * u), -0.05f - kPx * v, -std::cos(kPx * u)).normalized();
    const float distance = eye.y() / -direction.y();
    const Vec3 at = (eye + distance * direction) / kSide + Vec3::Constant(0.5f);  // x and z are its uv.
    const bool first = at.x() >= at.z();
    TriangleHit hit{&mesh, &placement, mesh.triangles[first ? 0 : 1], Vec3::Zero(), nullptr, {}};
    hit.weights = first ? Vec3(1.0f - at.x(), at.z(), at.x() - at.z()) : Vec3(1.0f - at.z(), at.z() - at.x(), at.x());
    const Footprint footprint{share * kPx * distance, -direction.y()};
    return TexelReader(hit, footprint)
        .at(material.base_colour, material.source->base_colour_texture, Coding::kSrgb)
        .x();
  }
  static constexpr float kSide = 400.0f;
  scene::Scene scene;
  MipTextures textures;
  SurfaceMaterial material;
  SurfaceMesh mesh;
  Placement placement;
};

TEST(TextureLevel, keeps_the_mean_of_a_far_floor_with_a_fraction_of_the_noise) {
  const Floor floor;
  std::mt19937 random(6);
  std::uniform_real_distribution<float> in_pixel(0.0f, 1.0f);
  constexpr int kPixels = 24;
  constexpr int kMany = 64;
  double reference_mean = 0.0, mean = 0.0, error = 0.0, error_of_level_0 = 0.0;
  for (int y = 0; y < kPixels; ++y) {
    for (int x = 0; x < kPixels; ++x) {
      const auto place = [&](int side) { return static_cast<float>(side) + in_pixel(random); };
      double reference = 0.0;
      for (int i = 0; i < kMany; ++i) reference += floor.red(place(x), place(y), 0.0f) / kMany;
      const double one = floor.red(place(x), place(y), 1.0f);
      const double one_of_level_0 = floor.red(place(x), place(y), 0.0f);
      reference_mean += reference / (kPixels * kPixels);
      mean += one / (kPixels * kPixels);
      error += (one - reference) * (one - reference);
      error_of_level_0 += (one_of_level_0 - reference) * (one_of_level_0 - reference);
    }
  }
  EXPECT_NEAR(mean, reference_mean, 0.01);
  EXPECT_LT(error, 0.1 * error_of_level_0);
}

}  // namespace
}  // namespace cyclorama::render
