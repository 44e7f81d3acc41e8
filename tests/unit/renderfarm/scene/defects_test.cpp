// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/defects.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "renderfarm/scene/mesh_topology.h"
#include "tests/data_sets/vitrine.h"

namespace cyclorama::scene {
namespace {

using testing::HasSubstr;

Model model_of(Mesh mesh) { return scene_of(std::move(mesh)).model; }

/// A statue of 3,968 triangles and 2 m; its triangles lie in rings, from the top.
Mesh statue() { return sphere_mesh(1.0f, 32); }

std::size_t places(const Defects& defects, DefectKind kind) { return defects.count(kind).places; }
std::size_t all_places(const Defects& defects) {
  std::size_t sum = 0;
  for (const DefectKind kind : kDefectKinds) sum += places(defects, kind);
  return sum;
}

/// Returns the volume inside of all triangles, as their fronts have it.
double volume_of(const Mesh& mesh) {
  double volume = 0.0;
  for (const auto& t : mesh.triangles) {
    const auto corner = [&](std::size_t i) {
      return Eigen::Vector3d(Eigen::Map<const Eigen::Vector3f>(mesh.positions[t[i]].data()).cast<double>());
    };
    volume += corner(0).dot(corner(1).cross(corner(2))) / 6.0;
  }
  return volume;
}

TEST(Defects, none_are_found_in_what_is_whole) {
  for (const Mesh& mesh : {statue(), square_mesh(2.0f), box_mesh({1.0f, 2.0f, 0.5f})}) {
    EXPECT_EQ(all_places(find_defects(model_of(mesh))), 0u);
  }
  EXPECT_EQ(all_places(find_defects(Model{})), 0u);
}

TEST(Defects, of_a_mesh_with_separate_corners_are_those_of_its_surface) {
  Mesh apart;
  const Mesh whole = statue();
  for (const auto& t : whole.triangles) {
    const auto first = static_cast<std::uint32_t>(apart.positions.size());
    for (const std::uint32_t corner : t) apart.positions.push_back(whole.positions[corner]);
    apart.triangles.push_back({first, first + 1, first + 2});
  }
  EXPECT_EQ(all_places(find_defects(model_of(apart))), 0u);
}

TEST(Defects, holes_are_counted_with_their_place_and_left) {
  Mesh mesh = statue();
  const auto middle = mesh.triangles[2000];
  std::erase_if(mesh.triangles, [&](const auto& t) { return std::ranges::find(t, middle[0]) != t.end(); });
  Model model = model_of(mesh);
  const Defects found = find_defects(model);
  EXPECT_EQ(places(found, DefectKind::kHole), 1u);
  EXPECT_EQ(found.count(DefectKind::kHole).triangles, 6u) << "edges";
  EXPECT_EQ(all_places(found), 1u);
  ASSERT_EQ(found.largest.size(), 1u);
  const auto& p = mesh.positions[middle[0]];
  EXPECT_LT((found.largest[0].middle - Eigen::Vector3d(p[0], p[1], p[2])).norm(), 0.1);
  EXPECT_GT(found.largest[0].facing.dot(found.largest[0].middle), 0.9) << "it is seen from outside";
  EXPECT_NEAR(found.largest[0].size_m, 0.25, 0.1);
  EXPECT_TRUE(repair_defects(&model).empty());
  EXPECT_EQ(model.meshes[0].triangles.size(), mesh.triangles.size());
}

TEST(Defects, turned_triangles_are_turned_back) {
  Mesh mesh = statue();
  const double volume = volume_of(mesh);
  for (std::size_t i = 1000; i < 1010; ++i) std::swap(mesh.triangles[i][0], mesh.triangles[i][1]);
  Model model = model_of(mesh);
  const Defects found = find_defects(model);
  EXPECT_EQ(found.count(DefectKind::kTurned).triangles, 10u);
  EXPECT_EQ(places(found, DefectKind::kHole), 0u);
  EXPECT_THAT(repair_defects(&model), testing::ElementsAre(HasSubstr("turned triangles (10 triangles)")));
  EXPECT_NEAR(volume_of(model.meshes[0]), volume, 1e-6);
  EXPECT_EQ(all_places(find_defects(model)), 0u);
}

TEST(Defects, what_is_inside_out_is_turned_unless_it_may_be_an_inside) {
  Mesh mesh = statue();
  for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
  Model model = model_of(mesh);
  EXPECT_EQ(places(find_defects(model), DefectKind::kInsideOut), 0u) << "3.4 m: a room";
  model.instances[0].T_model_mesh = Eigen::Affine3d(Eigen::Scaling(0.5));
  EXPECT_EQ(places(find_defects(model), DefectKind::kInsideOut), 1u);
  for (const bool sound : {false, true}) {
    Model mirrored = sound ? model_of(statue()) : model;
    mirrored.instances[0].T_model_mesh = Eigen::Affine3d(Eigen::Scaling(-0.5, 0.5, 0.5));
    EXPECT_EQ(all_places(find_defects(mirrored)), sound ? 0u : 1u) << "a mirrored mesh keeps its fronts";
  }
  Model hollow = model;
  hollow.meshes.push_back(statue());
  hollow.instances.push_back({1, Eigen::Affine3d(Eigen::Scaling(0.6))});
  EXPECT_EQ(all_places(find_defects(hollow)), 0u);
  EXPECT_THAT(repair_defects(&model), testing::ElementsAre(HasSubstr("surfaces inside out")));
  EXPECT_GT(volume_of(model.meshes[0]), 0.0);
}

TEST(Defects, debris_is_what_floats_and_is_small) {
  Scene scene = scene_of(statue());
  const auto at = [](double x, double y, double z) { return Eigen::Affine3d(Eigen::Translation3d(x, y, z)); };
  add_mesh(scene, sphere_mesh(0.02f, 4), at(1.3, 0.2, 0));
  add_mesh(scene, sphere_mesh(0.02f, 4), at(0, 1.005, 0));  // It lies on top.
  Model& model = scene.model;
  const Defects found = find_defects(model);
  EXPECT_EQ(places(found, DefectKind::kDebris), 1u);
  ASSERT_FALSE(found.largest.empty());
  EXPECT_LT((found.largest[0].middle - Eigen::Vector3d(1.3, 0.2, 0)).norm(), 0.01);
  EXPECT_THAT(repair_defects(&model), testing::ElementsAre(HasSubstr("floating debris")));
  EXPECT_TRUE(model.meshes[1].triangles.empty());
  EXPECT_FALSE(model.meshes[2].triangles.empty());
}

TEST(Defects, small_things_beside_a_floor_of_two_triangles_are_no_debris) {
  Scene scene = scene_of(square_mesh(4.0f));
  add_mesh(scene, sphere_mesh(0.02f, 4), Eigen::Affine3d(Eigen::Translation3d(0.3, 0.021, 0.4)));
  EXPECT_EQ(all_places(find_defects(scene.model)), 0u);
}

TEST(Defects, a_triangle_without_area_closes_the_gap_at_a_corner_on_an_edge) {
  Mesh mesh;  // A square whose lower edge has a corner in its middle on one side only.
  mesh.positions = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 0, 0}, {1, -20, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {5, 4, 0}, {5, 1, 4}, {0, 4, 1}};
  const Defects found = find_defects(model_of(mesh));
  EXPECT_EQ(places(found, DefectKind::kNoArea), 1u);
  EXPECT_EQ(places(found, DefectKind::kHole), 0u);
}

TEST(Defects, triangles_without_area_are_removed_and_slivers_stay) {
  Mesh mesh = statue();
  mesh.triangles.push_back({5, 5, 6});
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {{3.0f, 0.0f, 0.0f}, {4.0f, 0.0f, 0.0f}, {3.5f, 1e-4f, 0.0f}});
  mesh.triangles.push_back({first, first + 1, first + 2});
  Model model = model_of(mesh);
  const Defects found = find_defects(model);
  EXPECT_EQ(places(found, DefectKind::kNoArea), 1u);
  EXPECT_EQ(places(found, DefectKind::kSliver), 1u);
  repair_defects(&model);
  EXPECT_EQ(model.meshes[0].triangles.size(), mesh.triangles.size() - 1);
}

TEST(Topology, tells_a_moebius_strip_from_a_ring) {
  for (const bool twist : {false, true}) {
    TriangleSoup soup;
    constexpr std::uint32_t kParts = 12;
    for (std::uint32_t i = 0; i < kParts; ++i) {
      const double a = 2.0 * std::numbers::pi * i / kParts;
      const double tilt = twist ? 0.5 * a : 0.0;
      for (const double side : {-0.2, 0.2}) {
        const double r = 1.0 + side * std::cos(tilt);
        soup.places.emplace_back(r * std::cos(a), side * std::sin(tilt), r * std::sin(a));
      }
    }
    for (std::uint32_t i = 0; i < kParts; ++i) {
      std::uint32_t c = 2 * ((i + 1) % kParts);
      std::uint32_t d = c + 1;
      if (twist && i + 1 == kParts) std::swap(c, d);
      soup.triangles.push_back({2 * i, 2 * i + 1, c});
      soup.triangles.push_back({2 * i + 1, d, c});
    }
    const Topology topology = topology_of(soup);
    ASSERT_EQ(topology.sheets.size(), 1u);
    EXPECT_EQ(topology.sheets[0].twisted, twist);
    EXPECT_FALSE(topology.sheets[0].closed);
    if (!twist) {
      EXPECT_EQ(topology.rims.size(), 2u);
    }
  }
}

}  // namespace
}  // namespace cyclorama::scene
