// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_node.h"

#include <gmock/gmock.h>

#include <cmath>

#include "renderfarm/scene/gltf_transform.h"
#include "tests/unit/renderfarm/scene/gltf_builder.h"

namespace cyclorama::scene {
namespace {

using nlohmann::json;
using ::testing::Contains;
using ::testing::HasSubstr;

GltfBuilder with_nodes(const json& nodes, const json& roots) {
  GltfBuilder file = one_triangle();
  file.json["nodes"] = nodes;
  file.json["scenes"] = {{{"nodes", roots}}};
  return file;
}

const double kHalf = std::sqrt(0.5);

TEST(GltfNode, transforms_compose_from_root_to_leaf) {
  // Parent: rotated by a quarter turn about y and translated. Child: scaled, then translated.
  const GltfBuilder file =
      with_nodes({{{"children", {1}}, {"rotation", {0, kHalf, 0, kHalf}}, {"translation", {10, 0, 0}}},
                  {{"mesh", 0}, {"scale", {2, 2, 2}}, {"translation", {0, 0, 1}}}},
                 {0});
  const Result<Model> model = file.import();
  ASSERT_TRUE(model.has_value()) << error_of(model);
  ASSERT_EQ(model->instances.size(), 1u);
  const Eigen::Vector3d corner = model->instances[0].T_model_mesh * Eigen::Vector3d(1, 0, 0);
  EXPECT_TRUE(corner.isApprox(Eigen::Vector3d(11, 0, -2), 1e-12)) << corner.transpose();
}

TEST(GltfNode, a_matrix_is_read_by_columns) {
  const GltfBuilder file =
      with_nodes({{{"mesh", 0}, {"matrix", {0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1}}}}, {0});
  const Result<Model> model = file.import();
  ASSERT_TRUE(model.has_value());
  EXPECT_TRUE((model->instances[0].T_model_mesh * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(5, 7, 7)));
}

TEST(GltfNode, invalid_transforms_are_refused) {
  const json identity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  json projective = identity;
  projective[3] = 1;
  EXPECT_THAT(error_of(with_nodes({{{"mesh", 0}, {"matrix", projective}}}, {0}).import()), HasSubstr("last row"));
  EXPECT_THAT(error_of(with_nodes({{{"mesh", 0}, {"matrix", identity}, {"scale", {1, 1, 1}}}}, {0}).import()),
              HasSubstr("/nodes/0/matrix"));
  EXPECT_THAT(error_of(with_nodes({{{"mesh", 0}, {"rotation", {0, 0, 0, 0}}}}, {0}).import()), HasSubstr("rotation"));
  EXPECT_THAT(error_of(with_nodes({{{"mesh", 0}, {"matrix", {1, 2}}}}, {0}).import()), HasSubstr("16 numbers"));
}

TEST(GltfNode, a_rotation_that_is_not_of_unit_length_is_used_and_noted) {
  const Result<Model> model = with_nodes({{{"mesh", 0}, {"rotation", {0, 0, 0, 3}}}}, {0}).import();
  ASSERT_TRUE(model.has_value());
  EXPECT_TRUE(model->instances[0].T_model_mesh.matrix().isIdentity());
  EXPECT_THAT(model->notes, Contains(HasSubstr("unit length")));
}

TEST(GltfNode, a_node_without_volume_is_not_shown) {
  for (const json& scale : {json{0, 0, 0}, json{1, 0, 1}, json{1e-200, 1e-200, 1e-200}}) {
    const Result<Model> model = with_nodes({{{"mesh", 0}, {"scale", scale}}}, {0}).import();
    ASSERT_TRUE(model.has_value());
    EXPECT_TRUE(model->instances.empty()) << scale;
    EXPECT_THAT(model->notes, Contains(HasSubstr("scaled to nothing")));
  }
  // Small but not flat; mirrored.
  EXPECT_EQ(with_nodes({{{"mesh", 0}, {"scale", {-1e-3, 1e-3, 1e3}}}}, {0}).import()->instances.size(), 1u);
}

TEST(GltfNode, transforms_that_overflow_are_refused) {
  const GltfBuilder file = with_nodes(
      {{{"children", {1}}, {"scale", {1e200, 1e200, 1e200}}}, {{"mesh", 0}, {"scale", {1e200, 1e200, 1e200}}}}, {0});
  EXPECT_THAT(error_of(file.import()), HasSubstr("/nodes/1: the transform is too large"));
}

TEST(GltfNode, cycles_and_second_parents_are_refused_and_named) {
  EXPECT_THAT(error_of(with_nodes(json::array({{{"children", {0}}}}), {0}).import()),
              HasSubstr("/nodes/0: the node is part of a loop"));
  EXPECT_THAT(error_of(with_nodes({json::object(), {{"children", {2}}}, {{"children", {1}}}}, {0}).import()),
              HasSubstr("/nodes/1: the node is part of a loop"));
  EXPECT_THAT(error_of(with_nodes({{{"children", {2}}}, {{"children", {2}}}, json::object()}, {0, 1}).import()),
              HasSubstr("/nodes/1/children/0: node 2 is already a child of node 0"));
  EXPECT_THAT(error_of(with_nodes({{{"children", {7}}}}, {0}).import()), HasSubstr("index 7 of 1 nodes"));
  EXPECT_THAT(error_of(with_nodes({{{"mesh", 7}}}, {0}).import()), HasSubstr("/nodes/0/mesh: index 7 of 1 meshes"));
}

TEST(GltfNode, a_node_that_a_scene_names_as_root_though_it_is_a_child_or_twice_is_shown_once) {
  const json moved = {{"translation", {1, 0, 0}}, {"children", {1}}};
  const json shown = {{"translation", {2, 0, 0}}, {"mesh", 0}};
  const auto places = [&](const json& roots) {
    std::vector<double> x;
    const Result<Model> model = with_nodes({moved, shown}, roots).import();
    EXPECT_TRUE(model.has_value()) << error_of(model);
    for (const Instance& instance : model->instances) x.push_back(instance.T_model_mesh.translation().x());
    EXPECT_EQ(model->notes.empty(), roots == json({0}));
    return x;
  };
  EXPECT_THAT(places({0}), testing::ElementsAre(3.0));
  EXPECT_THAT(places({0, 1}), testing::ElementsAre(3.0));
  EXPECT_THAT(places({1, 0}), testing::ElementsAre(3.0));
  EXPECT_THAT(places({0, 0}), testing::ElementsAre(3.0));
  EXPECT_THAT(places({1}), testing::ElementsAre(2.0)) << "its parent is not shown";
}

TEST(GltfNode, a_hierarchy_of_a_hundred_thousand_levels_is_read) {
  json nodes = json::array();
  constexpr int kDeep = 100'000;
  for (int i = 0; i < kDeep; ++i) nodes.push_back({{"children", {i + 1}}, {"translation", {0, 0, 1}}});
  nodes.push_back({{"mesh", 0}});
  const Result<Model> model = with_nodes(nodes, {0}).import();
  ASSERT_TRUE(model.has_value()) << error_of(model);
  EXPECT_EQ(model->instances.at(0).T_model_mesh.translation().z(), kDeep);
}

TEST(GltfNode, shows_the_default_scene_the_first_one_or_everything) {
  GltfBuilder file = with_nodes({{{"mesh", 0}}, {{"mesh", 0}, {"translation", {5, 0, 0}}}}, {0});
  EXPECT_EQ(file.import()->instances.size(), 1u);
  file.json["scenes"].push_back({{"nodes", {1}}});
  file.json["scene"] = 1;
  EXPECT_EQ(file.import()->instances.at(0).T_model_mesh.translation().x(), 5.0);
  file.json["scene"] = 2;
  EXPECT_THAT(error_of(file.import()), HasSubstr("/scene: index 2 of 2 scenes"));
  file.json.erase("scene");
  file.json.erase("scenes");
  EXPECT_EQ(file.import()->instances.size(), 2u);
  file.json.erase("nodes");
  EXPECT_EQ(file.import()->instances.size(), 1u);
}

TEST(GltfNode, gpu_instancing_shows_a_mesh_many_times) {
  GltfBuilder file = one_triangle();
  const int shifts = file.add_floats({1, 0, 0, 2, 0, 0, 3, 0, 0}, "VEC3");
  const int turns =
      file.add_accessor<std::int16_t>({0, 0, 0, 32767, 0, 0, 32767, 0, 0, 0, 0, 32767}, "VEC4", 5122, true);
  file.json["nodes"][0]["translation"] = {0, 10, 0};
  auto& attributes = file.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
  attributes = {{"TRANSLATION", shifts}, {"ROTATION", turns}};
  const Result<Model> model = file.import();
  ASSERT_TRUE(model.has_value()) << error_of(model);
  ASSERT_EQ(model->instances.size(), 3u);
  EXPECT_EQ(model->meshes.size(), 1u);
  EXPECT_TRUE((model->instances[1].T_model_mesh * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(1, 10, 0)));
  attributes["SCALE"] = file.add_floats({1, 1, 1}, "VEC3");
  EXPECT_THAT(error_of(file.import()), HasSubstr("attributes/SCALE: 1 elements for 3 instances"));
  attributes = json::object();
  EXPECT_THAT(error_of(file.import()), HasSubstr("is needed here"));
}

TEST(GltfNode, instances_count_towards_the_memory_limit) {
  GltfBuilder file = one_triangle();
  file.add_floats({0, 0, 0}, "VEC3");
  file.json["accessors"][1].erase("bufferView");
  file.json["accessors"][1]["count"] = 1'000'000;
  file.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"TRANSLATION", 1}};
  ImportLimits limits;
  limits.memory_bytes = 100 << 20;
  EXPECT_THAT(error_of(file.import(limits)), HasSubstr("memory limit"));
}

GltfBuilder with_light(const json& light, const json& node) {
  GltfBuilder file = one_triangle();
  json carrier = node;
  carrier["extensions"]["KHR_lights_punctual"]["light"] = 0;
  file.json["nodes"].push_back(carrier);
  file.json["scenes"][0]["nodes"] = {0, 1};
  file.json["extensions"]["KHR_lights_punctual"]["lights"] = {light};
  return file;
}

TEST(GltfLight, a_spot_has_the_pose_of_its_node) {
  const Result<Model> model =
      with_light({{"type", "spot"},
                  {"name", "lamp"},
                  {"color", {1, 0.5, 0.25}},
                  {"intensity", 40},
                  {"range", 15},
                  {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.5}}}},
                 {{"rotation", {0, kHalf, 0, kHalf}}, {"translation", {1, 2, 3}}, {"scale", {3, 3, 3}}})
          .import();
  ASSERT_TRUE(model.has_value()) << error_of(model);
  ASSERT_EQ(model->lights.size(), 1u);
  const Light& light = model->lights[0];
  EXPECT_EQ(light.kind, LightKind::kSpot);
  EXPECT_EQ(light.name, "lamp");
  EXPECT_EQ(light.intensity, Eigen::Vector3f(40, 20, 10));
  EXPECT_EQ(light.range_m, 15.0);
  EXPECT_EQ(light.inner_cone_rad, 0.1);
  EXPECT_EQ(light.outer_cone_rad, 0.5);
  EXPECT_EQ(light.position, Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(light.direction.isApprox(Eigen::Vector3d(-1, 0, 0)));
}

TEST(GltfLight, has_the_specifications_defaults) {
  const Result<Model> model = with_light({{"type", "point"}}, json::object()).import();
  ASSERT_TRUE(model.has_value());
  EXPECT_EQ(model->lights.at(0).kind, LightKind::kPoint);
  EXPECT_EQ(model->lights.at(0).intensity, Eigen::Vector3f(1, 1, 1));
  EXPECT_EQ(model->lights.at(0).range_m, 0.0);
}

TEST(GltfLight, invalid_lights_are_refused_or_noted) {
  EXPECT_THAT(error_of(with_light({{"type", "spot"}}, json::object()).import()),
              HasSubstr("/extensions/KHR_lights_punctual/lights/0/spot: is missing"));
  const json inverted = {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.6}, {"outerConeAngle", 0.5}}}};
  EXPECT_THAT(error_of(with_light(inverted, json::object()).import()), HasSubstr("innerConeAngle"));
  EXPECT_THAT(error_of(with_light({{"type", "directional"}}, {{"scale", {0, 0, 0}}}).import()),
              HasSubstr("no direction"));
  EXPECT_THAT(with_light({{"type", "area"}}, json::object()).import()->notes, Contains(HasSubstr("ignored")));
  GltfBuilder file = with_light({{"type", "point"}}, json::object());
  file.json["nodes"][1]["extensions"]["KHR_lights_punctual"]["light"] = 3;
  EXPECT_THAT(error_of(file.import()), HasSubstr("index 3 of 1 lights"));
}

TEST(GltfViewpoint, a_camera_becomes_a_viewpoint) {
  GltfBuilder file =
      with_nodes({{{"mesh", 0}},
                  {{"camera", 0}, {"name", "stop"}, {"translation", {1, 2, 3}}, {"rotation", {0, kHalf, 0, kHalf}}}},
                 {0, 1});
  EXPECT_THAT(error_of(file.import()), HasSubstr("/nodes/1/camera: index 0 of 0 cameras"));
  file.json["cameras"] = {{{"type", "perspective"}}};
  const Result<Model> model = file.import();
  ASSERT_TRUE(model.has_value()) << error_of(model);
  ASSERT_EQ(model->viewpoints.size(), 1u);
  EXPECT_EQ(model->viewpoints[0].name, "stop");
  EXPECT_EQ(model->viewpoints[0].eye, Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(model->viewpoints[0].direction.isApprox(Eigen::Vector3d(-1, 0, 0)));
}

TEST(GltfTransform, invertible_means_finite_and_with_volume) {
  Eigen::Affine3d transform = Eigen::Affine3d::Identity();
  EXPECT_TRUE(is_invertible(transform));
  transform.linear() *= 1e-60;
  EXPECT_TRUE(is_invertible(transform));
  transform.linear().col(0) = transform.linear().col(1);
  EXPECT_FALSE(is_invertible(transform));
  transform = Eigen::Affine3d::Identity();
  transform.translation().x() = std::nan("");
  EXPECT_FALSE(is_invertible(transform));
}

}  // namespace
}  // namespace cyclorama::scene
