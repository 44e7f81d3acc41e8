// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_mesh.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "tests/support/model_invariants.h"
#include "tests/unit/renderfarm/scene/gltf_builder.h"

namespace cyclorama::scene {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::FloatNear;
using ::testing::HasSubstr;

using Triangle = std::array<std::uint32_t, 3>;
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

const std::vector<float> kSquare = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};

GltfBuilder square(int mode, const std::vector<std::uint16_t>& indices) {
  GltfBuilder file;
  nlohmann::json& primitive = file.add_primitive({{"POSITION", file.add_floats(kSquare, "VEC3")}});
  if (mode >= 0) primitive["mode"] = mode;
  if (!indices.empty()) primitive["indices"] = file.add_indices(indices);
  file.show();
  return file;
}

std::vector<Triangle> triangles_of(const GltfBuilder& file) {
  const Result<Model> model = file.import();
  EXPECT_TRUE(model.has_value()) << error_of(model);
  return model && !model->meshes.empty() ? model->meshes[0].triangles : std::vector<Triangle>();
}

TEST(GltfMesh, reads_triangles_strips_and_fans_with_their_winding) {
  EXPECT_THAT(triangles_of(square(-1, {0, 1, 2, 0, 2, 3})), ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
  EXPECT_THAT(triangles_of(square(5, {0, 1, 3, 2})), ElementsAre(Triangle{0, 1, 3}, Triangle{1, 2, 3}));
  EXPECT_THAT(triangles_of(square(6, {0, 1, 2, 3})), ElementsAre(Triangle{1, 2, 0}, Triangle{2, 3, 0}));
}

TEST(GltfMesh, uses_vertices_in_order_without_indices) {
  EXPECT_THAT(triangles_of(square(6, {})), ElementsAre(Triangle{1, 2, 0}, Triangle{2, 3, 0}));
  EXPECT_THAT(triangles_of(square(5, {})), ElementsAre(Triangle{0, 1, 2}, Triangle{1, 3, 2}));
  EXPECT_THAT(triangles_of(one_triangle()), ElementsAre(Triangle{0, 1, 2}));
}

TEST(GltfMesh, a_count_without_data_is_refused_before_triangles_are_made) {
  for (const bool has_view : {false, true}) {
    GltfBuilder file = square(4, {});
    nlohmann::json& accessor = file.json["accessors"][0];
    accessor["count"] = 1'000'000'000;  // 4 GB of corners, within the memory limit.
    if (!has_view) accessor.erase("bufferView");
    EXPECT_THAT(error_of(file.import()), HasSubstr("/accessors/0")) << has_view;
  }
}

TEST(GltfBudget, a_small_file_has_a_limit_that_grows_with_its_stored_bytes) {
  constexpr std::size_t kGiB = std::size_t{1} << 30;
  GltfBudget budget(8 * kGiB);
  EXPECT_EQ(budget.left_bytes(), 4 * kGiB);
  EXPECT_FALSE(budget.take("here", 5, kGiB).has_value());
  budget.earn(kGiB / 64);
  EXPECT_EQ(budget.left_bytes(), 5 * kGiB);
  EXPECT_TRUE(budget.take("here", 5, kGiB).has_value());
  budget.earn(~std::uint64_t{0});
  EXPECT_EQ(budget.left_bytes(), 3 * kGiB) << "never beyond the limit";
  EXPECT_EQ(GltfBudget(1000).left_bytes(), 1000u);
}

TEST(GltfMesh, drops_degenerate_connecting_triangles_of_strips) {
  EXPECT_THAT(triangles_of(square(5, {0, 1, 2, 2, 3, 0})), ElementsAre(Triangle{0, 1, 2}, Triangle{2, 0, 3}));
}

TEST(GltfMesh, reads_indices_of_every_width) {
  for (const int component : {5121, 5123, 5125}) {
    GltfBuilder file = square(4, {});
    const int index = component == 5121   ? file.add_accessor<std::uint8_t>({2, 1, 0}, "SCALAR", component)
                      : component == 5123 ? file.add_accessor<std::uint16_t>({2, 1, 0}, "SCALAR", component)
                                          : file.add_accessor<std::uint32_t>({2, 1, 0}, "SCALAR", component);
    file.json["meshes"][0]["primitives"][0]["indices"] = index;
    EXPECT_THAT(triangles_of(file), ElementsAre(Triangle{2, 1, 0})) << component;
  }
}

TEST(GltfMesh, points_are_shown_as_squares_with_their_colours) {
  GltfBuilder file = square(0, {});
  file.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] =
      file.add_floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1}, "VEC3");
  const Result<Model> model = file.import();
  ASSERT_TRUE(model.has_value()) << error_of(model);
  EXPECT_EQ(broken_promise(*model), "");
  ASSERT_EQ(model->meshes.size(), 1u);
  EXPECT_EQ(model->meshes[0].triangles.size(), 8u) << "two for each point";
  EXPECT_EQ(model->meshes[0].colours[4], (std::array<std::uint8_t, 4>{0, 255, 0, 255}));
  EXPECT_THAT(model->notes, Contains(HasSubstr("shown as small squares")));
  ImportLimits limits;
  limits.memory_bytes = 500;
  EXPECT_THAT(error_of(square(0, {}).import(limits)), HasSubstr("memory limit"));
}

TEST(GltfMesh, lines_and_primitives_without_positions_are_noted) {
  for (int mode = 1; mode < 4; ++mode) {
    const Result<Model> model = square(mode, {}).import();
    ASSERT_TRUE(model.has_value());
    EXPECT_TRUE(model->meshes.empty());
    EXPECT_THAT(model->notes, Contains(HasSubstr("lines have no surface"))) << mode;
  }
  GltfBuilder file;
  file.add_primitive({{"NORMAL", file.add_floats(kSquare, "VEC3")}});
  file.show();
  EXPECT_THAT(file.import()->notes, Contains(HasSubstr("no positions")));
  EXPECT_THAT(error_of(square(7, {}).import()), HasSubstr("/meshes/0/primitives/0/mode"));
}

TEST(GltfMesh, an_index_outside_the_vertices_names_its_accessor) {
  EXPECT_THAT(error_of(square(4, {0, 1, 4}).import()), HasSubstr("/accessors/1: index 4 of 4 vertices"));
}

TEST(GltfMesh, indices_of_a_wrong_type_are_refused) {
  GltfBuilder file = one_triangle();
  file.json["meshes"][0]["primitives"][0]["indices"] = file.add_floats({0, 1, 2}, "SCALAR");
  EXPECT_THAT(error_of(file.import()), HasSubstr("unsigned"));
  file.json["meshes"][0]["primitives"][0]["indices"] = 0;
  EXPECT_THAT(error_of(file.import()), HasSubstr("unsigned"));
  file.json["meshes"][0]["primitives"][0]["indices"] = 99;
  EXPECT_THAT(error_of(file.import()), HasSubstr("index 99 of 2 accessors"));
}

TEST(GltfMesh, leftover_vertices_are_noted) {
  const Result<Model> model = square(4, {}).import();
  ASSERT_TRUE(model.has_value());
  EXPECT_EQ(model->meshes[0].triangles.size(), 1u);
  EXPECT_THAT(model->notes, Contains(HasSubstr("make no triangle")));
}

TEST(GltfMesh, keeps_only_the_vertices_that_it_uses_of_a_shared_list) {
  GltfBuilder file;
  std::vector<float> many(300);
  for (std::size_t i = 0; i < many.size(); ++i) many[i] = static_cast<float>(i);
  const int positions = file.add_floats(many, "VEC3");
  file.add_primitive({{"POSITION", positions}})["indices"] = file.add_indices({90, 50, 7, 7, 50, 8});
  file.show();
  const Result<Model> model = file.import();
  ASSERT_TRUE(model.has_value()) << error_of(model);
  const Mesh& mesh = model->meshes[0];
  EXPECT_EQ(mesh.positions.size(), 4u);
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{3, 2, 0}, Triangle{0, 2, 1}));
  EXPECT_EQ(mesh.positions[3][0], 270.0f);
  EXPECT_EQ(mesh.positions[0][2], 23.0f);
}

TEST(GltfMesh, drops_triangles_with_corners_that_are_not_finite) {
  GltfBuilder file;
  file.add_primitive({{"POSITION", file.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0, kNaN, 0, 0}, "VEC3")}})["indices"] =
      file.add_indices({0, 1, 2, 1, 2, 3});
  file.show();
  const Result<Model> model = file.import();
  ASSERT_TRUE(model.has_value());
  EXPECT_THAT(model->meshes[0].triangles, ElementsAre(Triangle{0, 1, 2}));
  EXPECT_TRUE(std::isfinite(model->meshes[0].positions[3][0]));
  EXPECT_THAT(model->notes, Contains(HasSubstr("1 triangles have corners that are not finite")));
}

TEST(GltfMesh, normals_are_normalised_and_invalid_ones_replaced_by_the_surfaces) {
  GltfBuilder file = one_triangle();
  file.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] =
      file.add_floats({0, 0, 5, 0, 0, 0, kNaN, 0, 0}, "VEC3");
  const Result<Model> model = file.import();
  ASSERT_TRUE(model.has_value());
  for (const auto& normal : model->meshes[0].normals) EXPECT_THAT(normal, ElementsAre(0, 0, 1));
  EXPECT_THAT(model->notes, Contains(HasSubstr("2 normals have no direction")));
}

TEST(GltfMesh, without_normals_faces_are_flat) { EXPECT_TRUE(one_triangle().import()->meshes[0].normals.empty()); }

TEST(GltfMesh, vertex_colours_of_every_type_become_srgb) {
  // Linear 0.5 is code 188.
  const auto colours_of = [](GltfBuilder file, int accessor) {
    file.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = accessor;
    const Result<Model> model = file.import();
    EXPECT_TRUE(model.has_value()) << error_of(model);
    return model ? model->meshes[0].colours.at(0) : std::array<std::uint8_t, 4>{};
  };
  GltfBuilder f = one_triangle();
  const int float3 = f.add_floats({0.5f, 0, 1, 0, 0, 0, 0, 0, 0}, "VEC3");
  const int float4 = f.add_floats({0.5f, kNaN, 7, 0.5f, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC4");
  const int short4 =
      f.add_accessor<std::uint16_t>({32768, 0, 65535, 32768, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC4", 5123, true);
  const int byte3 = f.add_accessor<std::uint8_t>({128, 0, 255, 0, 0, 0, 0, 0, 0}, "VEC3", 5121, true);
  EXPECT_THAT(colours_of(f, float3), ElementsAre(188, 0, 255, 255));
  EXPECT_THAT(colours_of(f, float4), ElementsAre(188, 0, 255, 128));
  EXPECT_THAT(colours_of(f, short4), ElementsAre(188, 0, 255, 128));
  EXPECT_THAT(colours_of(f, byte3), ElementsAre(188, 0, 255, 255));
}

TEST(GltfMesh, attributes_of_wrong_type_or_count_are_refused) {
  GltfBuilder file = one_triangle();
  auto& attributes = file.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["NORMAL"] = file.add_floats({0, 0, 1}, "VEC3");
  EXPECT_THAT(error_of(file.import()), HasSubstr("attributes/NORMAL: 1 elements for 3 vertices"));
  attributes["NORMAL"] = file.add_floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC4");
  EXPECT_THAT(error_of(file.import()), HasSubstr("its type is not allowed"));
  attributes.erase("NORMAL");
  attributes["COLOR_0"] = file.add_accessor<std::uint32_t>(std::vector<std::uint32_t>(9), "VEC3", 5125);
  EXPECT_THAT(error_of(file.import()), HasSubstr("its type is not allowed"));
  attributes.erase("COLOR_0");
  attributes["POSITION"] = file.add_floats({0, 0, 1, 0, 0, 1}, "VEC2");
  EXPECT_THAT(error_of(file.import()), HasSubstr("its type is not allowed"));
}

TEST(GltfMesh, quantized_positions_need_the_extension) {
  GltfBuilder file;
  file.add_primitive({{"POSITION", file.add_accessor<std::int16_t>({0, 0, 0, 32767, 0, 0, 0, -32768, 0, 0, 0, 0},
                                                                   "VEC3", 5122, true)}});
  file.show();
  EXPECT_THAT(error_of(file.import()), HasSubstr("its type is not allowed"));
  file.json["extensionsUsed"] = {"KHR_mesh_quantization"};
  const Result<Model> model = file.import();
  ASSERT_TRUE(model.has_value()) << error_of(model);
  EXPECT_EQ(model->meshes[0].positions[1][0], 1.0f);
  EXPECT_EQ(model->meshes[0].positions[2][1], -1.0f);
}

TEST(GltfMesh, every_primitive_becomes_a_mesh_and_is_stored_once) {
  GltfBuilder file = one_triangle();
  file.add_primitive({{"POSITION", 0}});
  file.json["nodes"].push_back({{"mesh", 0}, {"translation", {1, 2, 3}}});
  file.json["scenes"][0]["nodes"] = {0, 1};
  const Result<Model> model = file.import();
  ASSERT_TRUE(model.has_value());
  EXPECT_EQ(model->meshes.size(), 2u);
  ASSERT_EQ(model->instances.size(), 4u);
  EXPECT_EQ(model->instances[3].mesh, 1);
  EXPECT_THAT(model->instances[3].T_model_mesh.translation(), Eigen::Vector3d(1, 2, 3));
}

TEST(GltfMesh, morph_targets_are_applied_at_the_meshs_own_weights) {
  GltfBuilder file = one_triangle();
  const int offsets = file.add_floats({1, 0, 0, 0, 2, 0, 0, 0, 4}, "VEC3");
  file.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", offsets}}, {{"POSITION", 0}}};
  const auto last_corner = [&] { return file.import()->meshes.at(0).positions.at(2); };
  EXPECT_EQ(last_corner(), (std::array<float, 3>{0, 1, 0})) << "without weights, the base shape";
  file.json["meshes"][0]["weights"] = {0.5, 0};
  EXPECT_EQ(last_corner(), (std::array<float, 3>{0, 1, 2}));
  EXPECT_THAT(file.import()->notes, Contains(HasSubstr("rest pose")));
  file.json["accessors"][static_cast<std::size_t>(offsets)]["count"] = 2;
  EXPECT_THAT(error_of(file.import()), HasSubstr("targets/0/POSITION: 2 elements of 3 numbers for 3 vertices"));
}

/// A triangle whose first two corners follow joint 0 and whose last follows joint 1 by half. Its own node is moved far
/// away, which does not count.
GltfBuilder skinned_triangle() {
  GltfBuilder file = one_triangle();
  auto& attributes = file.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_0"] = file.add_accessor<std::uint8_t>({0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0}, "VEC4", 5121);
  attributes["WEIGHTS_0"] = file.add_floats({1, 0, 0, 0, 1, 0, 0, 0, 0.5, 0.5, 0, 0}, "VEC4");
  attributes["NORMAL"] = file.add_floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
  // The first joint is bound where it stands; the second was bound at the origin.
  const int matrices = file.add_floats({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -7, 0, 0, 1,  //
                                        1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0,  0, 0, 1},
                                       "SCALAR");
  auto& accessor = file.json["accessors"][static_cast<std::size_t>(matrices)];
  accessor["type"] = "MAT4";
  accessor["count"] = 2;
  file.json["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"translation", {100, 0, 0}}},
                        {{"children", {2}}, {"translation", {7, 0, 0}}},
                        {{"translation", {-7, 0, 4}}}};
  file.json["scenes"] = {{{"nodes", {0, 1}}}};
  file.json["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", matrices}}};
  return file;
}

TEST(GltfMesh, a_skin_is_shown_in_its_rest_pose_wherever_its_own_node_is) {
  const Result<Model> model = skinned_triangle().import();
  ASSERT_TRUE(model.has_value()) << error_of(model);
  ASSERT_EQ(model->instances.size(), 1u);
  EXPECT_TRUE(model->instances[0].T_model_mesh.matrix().isIdentity());
  const Mesh& mesh = model->meshes.at(static_cast<std::size_t>(model->instances[0].mesh));
  EXPECT_EQ(mesh.positions[1], (std::array<float, 3>{1, 0, 0}));
  EXPECT_EQ(mesh.positions[2], (std::array<float, 3>{0, 1, 2})) << "half of the way of the second joint";
  EXPECT_EQ(mesh.normals[0], (std::array<float, 3>{0, 0, 1}));
  EXPECT_THAT(model->notes, Contains(HasSubstr("rest pose")));
}

TEST(GltfMesh, damaged_skins_are_refused_with_their_place) {
  GltfBuilder file = skinned_triangle();
  file.json["skins"][0]["joints"] = {1};
  EXPECT_THAT(error_of(file.import()), HasSubstr("/nodes/0: vertex 2 follows joint 1 of 1"));
  file.json["skins"][0]["joints"] = {1, 9};
  EXPECT_THAT(error_of(file.import()), HasSubstr("/skins/0/joints/1: index 9 of 3 nodes"));
  file.json["skins"][0]["joints"] = {1, 2, 2};
  EXPECT_THAT(error_of(file.import()), HasSubstr("3 matrices of 4 x 4 floats"));
  file = skinned_triangle();
  file.json["nodes"][0]["skin"] = 5;
  EXPECT_THAT(error_of(file.import()), HasSubstr("/nodes/0/skin: index 5 of 1 skins"));
}

}  // namespace
}  // namespace cyclorama::scene
