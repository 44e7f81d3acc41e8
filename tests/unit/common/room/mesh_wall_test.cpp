// SPDX-License-Identifier: Apache-2.0
#include "common/room/mesh_wall.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "common/room/triangle_tree.h"
#include "tests/data_sets/wall_meshes.h"

namespace cyclorama {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

const std::string kSquare = R"(v -1 0 -2
v 1 0 -2
v 1 2 -2
v -1 2 -2
f 1 2 3 4
)";

std::string complaint(const std::string& text) {
  const auto mesh = MeshWall::read(text);
  return mesh ? "" : mesh.error().message();
}

TEST(MeshWall, reads_files_as_other_programs_write_them) {
  EXPECT_EQ(MeshWall::read(kSquare)->triangle_count(), 2u);
  const auto rich = MeshWall::read(
      "mtllib wall.mtl\no wall\nv -1 0 -2\nv 1 0 -2\nv 1 2 -2 1 0 0\nvt 0 0\nvt 1 0\nvn 0 0 1\ns off\nusemtl grey\n"
      "f 1/1/1 2/2/1 -1//1 # A comment.\n");
  ASSERT_TRUE(rich) << rich.error().message();
  EXPECT_EQ(rich->triangle_count(), 1u);
  const auto hit = rich->hit({{Eigen::Vector3d(0.5, 0.5, 0)}, {0, 0, -1}});
  ASSERT_TRUE(hit);
  EXPECT_LT((hit->xyz - Eigen::Vector3d(0.5, 0.5, -2)).norm(), 1e-12);
}

TEST(MeshWall, names_the_line_of_a_mistake_and_the_remedy) {
  EXPECT_THAT(complaint(""), HasSubstr("no faces"));
  EXPECT_THAT(complaint("v 1 2\n"), StartsWith("line 1: has 2 numbers; 3 are needed"));
  EXPECT_THAT(complaint("v 1 2 x\n"), StartsWith("line 1: 'x' is not a number"));
  EXPECT_THAT(complaint("v 1 2 3mm\n"), StartsWith("line 1: '3mm' is not a number"));
  EXPECT_THAT(complaint("v 1 2 nan\n"), HasSubstr("'nan' is not a number"));
  EXPECT_THAT(complaint("v 1 2 1e999\n"), HasSubstr("'1e999' is not a number"));
  EXPECT_THAT(complaint("v 1500 0 0\n"), HasSubstr("the file is in metres"));
  EXPECT_THAT(complaint(kSquare + "f 1 2\n"), StartsWith("line 6: a face has 2 corners"));
  EXPECT_THAT(complaint(kSquare + "f 1 2 5\n"), StartsWith("line 6: '5' is none of the 4 positions above"));
  EXPECT_THAT(complaint(kSquare + "f 1 2 0\n"), HasSubstr("'0' is none"));
  EXPECT_THAT(complaint(kSquare + "f 1 2 -5\n"), HasSubstr("'-5' is none"));
  EXPECT_THAT(complaint(kSquare + "f 1/1 2/1 3/1\n"), HasSubstr("'1' is none of the 0 texture coordinates above"));
  EXPECT_THAT(complaint(kSquare + "f 1 2 2\n"), HasSubstr("no area"));
  EXPECT_THAT(complaint(kSquare + "curv 0 1 2 3\n"), HasSubstr("'curv' is not understood"));
}

TEST(MeshWall, refuses_faces_of_inconsistent_orientation) {
  EXPECT_THAT(complaint("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 3 4\n"),
              StartsWith("line 6: this face runs against the one in line 5"));
  // The same even though the corners are stored once for each face.
  EXPECT_THAT(complaint("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 4 5 6\n"),
              HasSubstr("runs against"));
}

TEST(MeshWall, approximates_the_shape_from_which_it_was_made) {
  const CylinderWall round{.radius_m = 3.0, .arc_rad = 2.2, .bottom_m = 0.4, .top_m = 2.9};
  const auto mesh = MeshWall::read(obj_of(round, 500, 10));
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->triangle_count(), 10000u);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  int hits = 0;
  for (int i = 0; i < 5000; ++i) {
    const RoomRay ray{{Eigen::Vector3d(unit(random), 1.6 + unit(random), unit(random))},
                      Eigen::Vector3d(unit(random), 0.5 * unit(random), -1.0)};
    const auto exact = round.hit(ray);
    const auto meshed = mesh->hit(ray);
    if (!exact || !meshed) continue;
    ++hits;
    EXPECT_LT((exact->xyz - meshed->xyz).norm(), 1e-4);
  }
  EXPECT_GT(hits, 2000);
}

TEST(MeshWall, has_creases_only_at_visible_edges) {
  EXPECT_TRUE(MeshWall::read(kSquare)->creases().empty());  // Neither its diagonal nor its rim is a crease.
  const auto folded =
      MeshWall::read("v -1 0 0\nv 0 0 -1\nv 1 0 0\nv -1 2 0\nv 0 2 -1\nv 1 2 0\nf 1 2 5 4\nf 2 3 6 5\n");
  ASSERT_TRUE(folded);
  ASSERT_EQ(folded->creases().size(), 1u);
  EXPECT_EQ(folded->creases()[0].from.xyz.x(), 0.0);
  EXPECT_EQ(folded->creases()[0].to.xyz.x(), 0.0);
}

TEST(TriangleTree, agrees_with_a_search_of_all_triangles) {
  std::mt19937 random(8);
  std::normal_distribution<double> normal;
  const auto vector = [&] { return Eigen::Vector3d(normal(random), normal(random), normal(random)); };
  std::vector<TriangleCorners> triangles;
  for (int i = 0; i < 700; ++i) {
    const Eigen::Vector3d middle = 3.0 * vector();
    triangles.push_back({middle + 0.4 * vector(), middle + 0.4 * vector(), middle + 0.4 * vector()});
  }
  const TriangleTree tree(triangles);
  std::vector<TriangleTree> alone;
  for (const TriangleCorners& t : triangles) alone.emplace_back(std::vector{t});
  int hits = 0;
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d origin = 5.0 * vector();
    const Eigen::Vector3d direction =
        i % 10 == 0 ? Eigen::Vector3d(0, 0, -origin.z()) : Eigen::Vector3d(vector() - origin);
    double nearest = std::numeric_limits<double>::infinity();
    for (const TriangleTree& one : alone) {
      if (const auto met = one.hit(origin, direction)) nearest = std::min(nearest, met->along);
    }
    const auto found = tree.hit(origin, direction);
    ASSERT_EQ(found.has_value(), std::isfinite(nearest));
    if (!found) continue;
    ++hits;
    EXPECT_EQ(found->along, nearest);
  }
  EXPECT_GT(hits, 300);
  EXPECT_FALSE(TriangleTree().hit({0, 0, 0}, {0, 0, 1}));
}

}  // namespace
}  // namespace cyclorama
