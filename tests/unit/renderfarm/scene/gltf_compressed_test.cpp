// SPDX-License-Identifier: Apache-2.0
// Compressed files of other programs.
#include <gmock/gmock.h>

#include <cmath>

#include "common/image/image_file.h"
#include "renderfarm/scene/assemble.h"
#include "renderfarm/scene/model.h"
#include "tests/data_sets/shared_data.h"

namespace cyclorama::scene {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

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

TEST(GltfCompressed, what_is_required_and_not_supported_is_refused_by_name) {
  CYCLORAMA_SHARED_DATA(folder, "gltf-compressed");
  const Result<Model> model = import_gltf(folder / "MeshoptCubeTest/MeshoptCubeTest.gltf", {});
  ASSERT_FALSE(model.has_value());
  EXPECT_THAT(model.error().message(), HasSubstr("KHR_meshopt_compression is required"));
}

}  // namespace
}  // namespace cyclorama::scene
