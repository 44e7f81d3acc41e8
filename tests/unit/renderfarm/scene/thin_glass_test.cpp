// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/thin_glass.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/data_sets/vitrine.h"

namespace cyclorama::scene {
namespace {

/// Adds the triangles of `inner`, turned around, to `mesh`.
void add_inside(const Mesh& inner, Mesh* mesh) {
  const auto first = static_cast<std::uint32_t>(mesh->positions.size());
  mesh->positions.insert(mesh->positions.end(), inner.positions.begin(), inner.positions.end());
  for (const auto& t : inner.triangles) mesh->triangles.push_back({first + t[0], first + t[2], first + t[1]});
}

Mesh shell(float radius, float thickness) {
  Mesh mesh = sphere_mesh(radius, 24);
  add_inside(sphere_mesh(radius - thickness, 24), &mesh);
  return mesh;
}

TEST(ThinGlass, a_plate_has_its_thickness_wherever_it_stands) {
  const Mesh plate = box_mesh({1.0f, 0.006f, 0.7f});
  ASSERT_TRUE(plate_thickness_m(plate, 1.0).has_value());
  EXPECT_NEAR(*plate_thickness_m(plate, 1.0), 0.006, 1e-6);
  ASSERT_TRUE(plate_thickness_m(plate, 2.0).has_value());
  EXPECT_NEAR(*plate_thickness_m(plate, 2.0), 0.012, 1e-6);
  EXPECT_FALSE(plate_thickness_m(plate, 10.0).has_value()) << "6 cm thick";
}

TEST(ThinGlass, a_case_in_one_mesh_and_a_thin_vessel_are_plates) {
  Mesh box = box_mesh({0.6f, 0.5f, 0.4f});
  add_inside(box_mesh({0.59f, 0.49f, 0.39f}), &box);
  ASSERT_TRUE(plate_thickness_m(box, 1.0).has_value());
  EXPECT_NEAR(*plate_thickness_m(box, 1.0), 0.005, 1e-4);
  ASSERT_TRUE(plate_thickness_m(shell(0.2f, 0.004f), 1.0).has_value());
  EXPECT_NEAR(*plate_thickness_m(shell(0.2f, 0.004f), 1.0), 0.004, 2e-4);
}

TEST(ThinGlass, solid_things_and_single_sheets_are_none) {
  EXPECT_FALSE(plate_thickness_m(sphere_mesh(0.01f, 16), 1.0).has_value()) << "a bead";
  EXPECT_FALSE(plate_thickness_m(box_mesh({0.03f, 0.03f, 0.02f}), 1.0).has_value()) << "a small block";
  EXPECT_FALSE(plate_thickness_m(square_mesh(1.0f), 1.0).has_value()) << "no body";
  Mesh lens = sphere_mesh(0.06f, 32);
  for (auto& p : lens.positions) p[1] *= 0.1f;
  EXPECT_FALSE(plate_thickness_m(lens, 1.0).has_value()) << "a lens";
  EXPECT_FALSE(plate_thickness_m(Mesh{}, 1.0).has_value());
}

TEST(ThinGlass, of_the_plates_alone_becomes_thin_and_keeps_half_of_the_absorption_in_each_face) {
  Model model = vitrine(VitrineLight::kDisk).model;
  model.materials[1].attenuation_colour = {0.25f, 1.0f, 1.0f};
  model.materials[1].attenuation_distance = 0.006f;
  Mesh ball = sphere_mesh(0.1f, 16, 1);
  model.instances.push_back({static_cast<int>(model.meshes.size()), Eigen::Affine3d::Identity()});
  model.meshes.push_back(ball);
  make_plates_thin(&model);
  ASSERT_EQ(model.materials.size(), 3u);
  EXPECT_EQ(std::count_if(model.meshes.begin(), model.meshes.end(), [](const Mesh& m) { return m.material == 2; }), 5);
  EXPECT_EQ(model.meshes.back().material, 1) << "the ball";
  EXPECT_EQ(model.materials[2].thickness, 0.0f);
  EXPECT_NEAR(model.materials[2].base_colour[0], 0.5f, 1e-4f);
  EXPECT_NEAR(model.materials[2].base_colour[1], 1.0f, 1e-6f);
  EXPECT_NEAR(model.materials[1].thickness, 0.006f, 1e-9f);
  ASSERT_EQ(model.notes.size(), 1u);
  EXPECT_NE(model.notes[0].find("'glass' is glass in plates 6.0 mm thick"), std::string::npos) << model.notes[0];
}

TEST(ThinGlass, stays_a_body_where_it_is_frosted_or_not_placed) {
  Model model = vitrine(VitrineLight::kDisk).model;
  model.materials[1].roughness = 0.4f;
  make_plates_thin(&model);
  EXPECT_EQ(model.materials.size(), 2u);
  model.materials[1].roughness = 0.0f;
  model.instances.clear();
  make_plates_thin(&model);
  EXPECT_EQ(model.materials.size(), 2u);
}

}  // namespace
}  // namespace cyclorama::scene
