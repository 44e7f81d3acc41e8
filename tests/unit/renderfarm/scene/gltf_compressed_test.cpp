// SPDX-License-Identifier: Apache-2.0
// Compressed files of other programs.
#include <gmock/gmock.h>

#include <cmath>
#include <map>

#include "common/image/image_file.h"
#include "renderfarm/scene/assemble.h"
#include "renderfarm/scene/model.h"
#include "tests/data_sets/shared_data.h"

namespace cyclorama::scene {
namespace {

std::size_t triangles_of(const Model& model) {
  std::size_t count = 0;
  for (const Instance& instance : model.instances) {
    count += model.meshes[static_cast<std::size_t>(instance.mesh)].triangles.size();
  }
  return count;
}

TEST(GltfCompressed, meshopt_and_quantized_files_have_all_their_triangles) {
  CYCLORAMA_SHARED_DATA(folder, "gltf-compressed");
  const std::vector<std::pair<const char*, std::size_t>> files = {{"pirate.glb", 5010},
                                                                  {"BoxMeshopt.glb", 12},
                                                                  {"BoxTextured_meshopt.glb", 12},
                                                                  {"DenseSphere.glb", 30720},
                                                                  {"khr_meshopt_fallback/meshopt-fallback.gltf", 60}};
  for (const auto& [name, triangles] : files) {
    const Result<Model> model = import_gltf(folder / name, {});
    ASSERT_TRUE(model.has_value()) << model.error().message();
    EXPECT_EQ(triangles_of(*model), triangles) << name;
    for (const Mesh& mesh : model->meshes) {
      for (const std::array<float, 3>& n : mesh.normals) {
        ASSERT_NEAR(std::hypot(n[0], n[1], n[2]), 1.0f, 1e-3f) << name;
      }
    }
  }
  const Result<Model> box = import_gltf(folder / "BoxMeshopt.glb", {});
  EXPECT_TRUE(bounds_of(*box).sizes().isApprox(Eigen::Vector3d::Ones(), 1e-3)) << bounds_of(*box).sizes();
}

TEST(GltfCompressed, all_modes_versions_and_filters_of_khr_meshopt_compression_are_read) {
  CYCLORAMA_SHARED_DATA(folder, "gltf-compressed");
  const Result<Model> model = import_gltf(folder / "MeshoptCubeTest/MeshoptCubeTest.gltf", {});
  ASSERT_TRUE(model.has_value()) << model.error().message();
  // The file tests each mode, version and filter with a cube of the same size and colours (and labels them with flat
  // squares, whose pictures are absent).
  std::map<std::array<long, 6>, std::array<std::uint8_t, 4>> colours;
  std::size_t cubes = 0;
  for (const Mesh& mesh : model->meshes) {
    Eigen::AlignedBox3f box;
    for (const std::array<float, 3>& p : mesh.positions) box.extend(Eigen::Vector3f(p[0], p[1], p[2]));
    if (box.sizes().z() == 0.0f) continue;
    ++cubes;
    EXPECT_TRUE(box.sizes().isApprox(Eigen::Vector3f::Ones(), 1e-3f)) << box.sizes().transpose();
    for (std::size_t i = 0; i < mesh.colours.size(); ++i) {
      const Eigen::Vector3f p(mesh.positions[i].data());
      const std::array<float, 3>& n = mesh.normals.at(i);
      const std::array<long, 6> at = {p.x() > 0.0f,      p.y() > 0.0f,      p.z() > 0.0f,
                                      std::lround(n[0]), std::lround(n[1]), std::lround(n[2])};
      const auto [first, is_new] = colours.emplace(at, mesh.colours[i]);
      for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(first->second[k], mesh.colours[i][k], 2) << cubes;
    }
  }
  EXPECT_EQ(cubes, 25u);
  EXPECT_EQ(colours.size(), 24u);
}

TEST(GltfCompressed, webp_textures_are_read_with_and_without_a_fallback) {
  CYCLORAMA_SHARED_DATA(folder, "gltf-compressed");
  for (const char* const name : {"webp_embedded.gltf", "webp_with_fallback/box-textured-with-fallback.gltf"}) {
    const Result<Model> model = import_gltf(folder / name, {});
    ASSERT_TRUE(model.has_value()) << model.error().message();
    ASSERT_EQ(model->textures.size(), 1u) << name;
    EXPECT_EQ(model->textures[0].pixels.width(), 128) << name;
    EXPECT_THAT(model->notes, ::testing::IsEmpty()) << name;
  }
}

TEST(GltfCompressed, basis_universal_textures_are_read) {
  CYCLORAMA_SHARED_DATA(folder, "gltf-compressed");
  const Result<Model> balloon = import_gltf(folder / "CesiumBalloonKTX2.glb", {});
  ASSERT_TRUE(balloon.has_value()) << balloon.error().message();
  EXPECT_EQ(balloon->textures.size(), 3u);
  const Result<Model> logo = import_gltf(folder / "agi_ktx2.glb", {});
  ASSERT_TRUE(logo.has_value()) << logo.error().message();
  ASSERT_EQ(logo->textures.size(), 1u);
  EXPECT_EQ(logo->textures[0].pixels.width(), 1024);
  EXPECT_THAT(logo->notes, ::testing::IsEmpty());
}

/// The same photograph as JPEG and as UASTC: they differ by their compression alone.
TEST(GltfCompressed, uastc_is_the_photograph_that_it_was_made_of) {
  CYCLORAMA_SHARED_DATA(folder, "gltf-compressed/ktx2");
  const Result<RgbaImage> photograph = read_image(folder / "kota.jpg", kTextureLimitPx);
  ASSERT_TRUE(photograph.has_value()) << photograph.error().message();
  for (const char* const name : {"kota-onelevel.ktx2", "kota-mipmaps.ktx2"}) {
    const Result<RgbaImage> texture = read_image(folder / name, kTextureLimitPx);
    ASSERT_TRUE(texture.has_value()) << texture.error().message();
    ASSERT_EQ(texture->data().size(), photograph->data().size());
    double sum = 0.0;
    for (std::size_t i = 0; i < texture->data().size(); ++i) {
      const int difference = int{texture->data()[i]} - int{photograph->data()[i]};
      sum += difference * difference;
    }
    EXPECT_LT(std::sqrt(sum / static_cast<double>(texture->data().size())), 4.0) << name;
  }
}

}  // namespace
}  // namespace cyclorama::scene
