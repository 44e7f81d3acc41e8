// SPDX-License-Identifier: Apache-2.0
// Gaussian splats in PLY and glTF, and scenes of them.
#include <gmock/gmock.h>

#include <cmath>

#include "renderfarm/scene/assemble.h"
#include "renderfarm/scene/scene.h"
#include "tests/data_sets/shared_data.h"
#include "tests/support/memory_file.h"
#include "tests/support/splat_ply.h"
#include "tests/unit/renderfarm/scene/gltf_builder.h"

namespace cyclorama::scene {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

Result<Model> import_ply_text(const std::string& text, const ImportLimits& limits = {}) {
  const MemoryFile file(text);
  return import_ply(file.path(), limits);
}

TEST(SplatPly, rows_are_decoded_and_turned_upright) {
  const auto model = import_ply_text(splat_ply_header(1, 1) + splat_ply_row({1, 2, 3}, 1));
  ASSERT_TRUE(model.has_value()) << model.error().message();
  const SplatCloud& cloud = model->splats.at(0);
  ASSERT_EQ(cloud.size(), 1u);
  EXPECT_EQ(cloud.degree, 1);
  EXPECT_NEAR(cloud.opacities[0], 0.5f, 1e-6f);
  EXPECT_NEAR(cloud.scales[0][0], std::exp(-1.0f), 1e-6f);
  EXPECT_NEAR(cloud.rotations[0][0], 1.0f, 1e-6f);
  // The file's coefficients are 1 to 9: those of red, then of green, then of blue.
  EXPECT_EQ(cloud.coefficients[1], (std::array<float, 3>{1, 4, 7}));
  EXPECT_EQ(cloud.coefficients[3], (std::array<float, 3>{3, 6, 9}));
  const Eigen::Vector3d p = cloud.T_model_cloud * Eigen::Vector3d(1, 2, 3);
  EXPECT_TRUE(p.isApprox(Eigen::Vector3d(1, -2, -3), 1e-12)) << p;
}

TEST(SplatPly, damaged_files_are_refused_with_the_reason) {
  const std::string row = splat_ply_row({0, 0, 0}, 0);
  EXPECT_THAT(import_ply_text(splat_ply_header(2, 0) + row).error().message(), HasSubstr("announces 2 rows"));
  const std::string shorter = row.substr(0, row.size() - 2) + "\n";
  EXPECT_THAT(import_ply_text(splat_ply_header(2, 0) + row + shorter).error().message(),
              HasSubstr("row 1 of 'vertex': line"));
  std::string odd = splat_ply_header(1, 1);
  odd.replace(odd.find("f_rest_8"), 8, "f_best_8");
  EXPECT_THAT(import_ply_text(odd + splat_ply_row({0, 0, 0}, 1)).error().message(), HasSubstr("8 coefficients"));
  std::string no_opacity = splat_ply_header(1, 0);
  no_opacity.replace(no_opacity.find("opacity"), 7, "opaquer");
  EXPECT_THAT(import_ply_text(no_opacity + splat_ply_row({0, 0, 0}, 0)).error().message(), HasSubstr("no 'opacity'"));
  EXPECT_THAT(import_ply_text(splat_ply_header(1, 0) + splat_ply_row({NAN, 0, 0}, 0)).error().message(),
              HasSubstr("none of its splats"));
  EXPECT_THAT(
      import_ply_text(splat_ply_header(1, 3) + splat_ply_row({0, 0, 0}, 3), {.memory_bytes = 100}).error().message(),
      HasSubstr("need more than"));
}

/// One splat with every attribute.
GltfBuilder splat_file(const std::vector<float>& scale) {
  GltfBuilder file;
  auto& primitive =
      file.add_primitive({{"POSITION", file.add_floats({1, 2, 3}, "VEC3")},
                          {"KHR_gaussian_splatting:ROTATION", file.add_floats({0, 0, 0, 1}, "VEC4")},
                          {"KHR_gaussian_splatting:SCALE", file.add_floats(scale, "VEC3")},
                          {"KHR_gaussian_splatting:OPACITY", file.add_floats({0.5f}, "SCALAR")},
                          {"KHR_gaussian_splatting:SH_DEGREE_0_COEF_0", file.add_floats({1, 0, -1}, "VEC3")}});
  primitive["mode"] = 0;
  primitive["extensions"]["KHR_gaussian_splatting"] = {{"kernel", "ellipse"}, {"colorSpace", "lin_rec709_display"}};
  file.json["extensionsUsed"] = {"KHR_gaussian_splatting"};
  file.show();
  return file;
}

TEST(GltfSplats, attributes_are_read_and_nodes_place_them) {
  GltfBuilder file = splat_file({1, 2, 3});
  file.json["nodes"][0]["translation"] = {10, 0, 0};
  const auto model = file.import({});
  ASSERT_TRUE(model.has_value()) << model.error().message();
  ASSERT_EQ(model->splats.size(), 1u);
  const SplatCloud& cloud = model->splats[0];
  EXPECT_EQ(cloud.scales[0], (std::array<float, 3>{1, 2, 3}));
  EXPECT_EQ(cloud.rotations[0], (std::array<float, 4>{1, 0, 0, 0}));
  EXPECT_TRUE(cloud.is_linear);
  EXPECT_TRUE((cloud.T_model_cloud * Eigen::Vector3d(1, 2, 3)).isApprox(Eigen::Vector3d(11, 2, 3)));
  EXPECT_THAT(model->notes, ::testing::IsEmpty());
}

TEST(GltfSplats, negative_scales_are_the_logarithms_of_drafts) {
  const auto model = splat_file({0, -1, 1}).import({});
  ASSERT_TRUE(model.has_value()) << model.error().message();
  EXPECT_NEAR(model->splats[0].scales[0][1], std::exp(-1.0f), 1e-6f);
  EXPECT_THAT(model->notes, Contains(HasSubstr("logarithms")));
}

TEST(GltfSplats, attributes_of_other_lengths_are_refused_with_their_place) {
  GltfBuilder file = splat_file({1, 2, 3, 4, 5, 6});
  EXPECT_THAT(file.import({}).error().message(), HasSubstr("has 2 values for 1 splats"));
  GltfBuilder without = splat_file({1, 2, 3});
  without.json["meshes"][0]["primitives"][0]["attributes"].erase("KHR_gaussian_splatting:OPACITY");
  EXPECT_THAT(without.import({}).error().message(), HasSubstr("KHR_gaussian_splatting:OPACITY: is missing"));
}

TEST(GltfSplats, files_of_bevy_and_cesium_are_read) {
  CYCLORAMA_SHARED_DATA(folder, "scans/splats");
  for (const char* const name : {"khr_conformance_matrix.gltf", "khr_conformance_matrix.glb"}) {
    const auto matrix = import_gltf(folder / name, {});
    ASSERT_TRUE(matrix.has_value()) << matrix.error().message();
    ASSERT_EQ(matrix->splats.size(), 15u);
    EXPECT_EQ(matrix->splats[14].degree, 3);
  }
  const auto fallback = import_gltf(folder / "khr_extensible_fallback.gltf", {});
  ASSERT_TRUE(fallback.has_value()) << fallback.error().message();
  EXPECT_EQ(fallback->splats.size(), 1u);
  EXPECT_THAT(fallback->notes, Contains(HasSubstr("customShape")));
  const auto cesium = import_gltf(folder / "spz_in_gltf.glb", {});
  ASSERT_TRUE(cesium.has_value()) << cesium.error().message();
  EXPECT_EQ(cesium->splats.size(), 1u);
}

TEST(SplatScenes, splats_alone_are_a_scene_without_lamps_before_a_dark_grey) {
  std::string text = splat_ply_header(400, 0);
  for (int i = 0; i < 400; ++i) {
    const int row = i / 20;
    text += splat_ply_row({0.1 * (i % 20), 0.1 * row, 0.3 * std::sin(i)}, 0);
  }
  const MemoryFile file(text);
  const auto scene = load_scene(file.path(), {}, nullptr);
  ASSERT_TRUE(scene.has_value()) << scene.error().message();
  EXPECT_TRUE(scene->model.lights.empty());
  EXPECT_GT(scene->sky.zenith.maxCoeff(), 0.0f) << "so that the outline is seen";
  EXPECT_LT(scene->sky.zenith.maxCoeff(), 0.05f);
  EXPECT_EQ(scene->exposure, 1.0);
  EXPECT_EQ(scene->tone, ToneCurve::kLinear);
  EXPECT_FALSE(scene->bounds.contains(scene->info.start_eye)) << "an object is looked at from outside";
  EXPECT_GE(scene->memory_bytes(), 400 * bytes_per_splat(0));
}

TEST(SplatScenes, a_stray_splat_does_not_stretch_the_bounds) {
  SplatCloud cloud;
  const std::array<std::array<float, 3>, 1> grey{};
  for (int i = 0; i < 1000; ++i) {
    SplatValues values;
    const int layer = i / 100;
    values.position = {i % 10 * 0.1, i / 10 % 10 * 0.1, layer * 0.1};
    values.scale.setConstant(0.01);
    ASSERT_TRUE(add_splat(values, grey, &cloud));
  }
  SplatValues stray;
  stray.position = {5000.0, 0.0, 0.0};
  ASSERT_TRUE(add_splat(stray, grey, &cloud));
  EXPECT_LT(bounds_of(cloud).max().x(), 1.1);
}

}  // namespace
}  // namespace cyclorama::scene
