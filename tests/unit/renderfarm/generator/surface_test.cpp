// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/generator/surface.h"

#include <gmock/gmock.h>

#include "renderfarm/generator/sculpture.h"
#include "renderfarm/generator/solid.h"

namespace cyclorama::generator {
namespace {

/// Keeps everything that it receives.
class KeptFile final : public GeometryFile {
 public:
  Status add_vertices(std::span<const Vertex> more) override {
    vertices.insert(vertices.end(), more.begin(), more.end());
    return Done{};
  }
  Status add_triangles(std::span<const Triangle> more) override {
    triangles.insert(triangles.end(), more.begin(), more.end());
    return Done{};
  }
  Status finish() override { return Done{}; }

  [[nodiscard]] Vec3 corner(const Triangle& triangle, std::size_t i) const {
    return Vec3(vertices[triangle[i]].position.data());
  }
  [[nodiscard]] Vec3 geometric_normal(const Triangle& t) const {
    return (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0)).normalized();
  }

  std::vector<Vertex> vertices;
  std::vector<Triangle> triangles;
};

bool always(std::uint64_t) { return true; }

Patch plane() {
  Patch patch;
  patch.width_m = 2.0f;
  patch.height_m = 1.0f;
  patch.columns = 8;
  patch.rows = 3;
  patch.at = [](float u, float v, float) { return Surfel{{2.0f * u, v, 0.0f}, {u, v, 2.0f}}; };
  return patch;
}

TEST(Patch, a_plane_becomes_a_grid_with_its_normal_and_clipped_colours) {
  KeptFile file;
  const Part part{"plane.ply", {plane()}};
  ASSERT_TRUE(write_part(part, file, always).has_value());
  EXPECT_EQ(file.vertices.size(), 9u * 4u);
  EXPECT_EQ(file.triangles.size(), 48u);
  EXPECT_EQ(file.vertices.size(), part.counts().vertices);
  EXPECT_EQ(file.triangles.size(), part.counts().triangles);
  float area = 0.0f;
  for (const Triangle& t : file.triangles) {
    EXPECT_TRUE(file.geometric_normal(t).isApprox(Vec3::UnitZ()));
    area += 0.5f * (file.corner(t, 1) - file.corner(t, 0)).cross(file.corner(t, 2) - file.corner(t, 0)).norm();
  }
  EXPECT_NEAR(area, 2.0f, 1e-5f);
  for (const Vertex& v : file.vertices) EXPECT_TRUE(Vec3(v.normal.data()).isApprox(Vec3::UnitZ()));
  EXPECT_EQ(file.vertices.back().colour, (std::array<std::uint8_t, 3>{255, 255, 255}));
  EXPECT_EQ(file.vertices.front().colour, (std::array<std::uint8_t, 3>{0, 0, 255}));
}

TEST(Patch, turns_towards_a_point_or_away_from_it) {
  for (const float side : {-1.0f, 1.0f}) {
    for (const bool away : {false, true}) {
      Part part{"plane.ply", {plane()}};
      turn_towards(part.patches[0], {1.0f, 0.5f, side}, away);
      KeptFile file;
      ASSERT_TRUE(write_part(part, file, always).has_value());
      const float expected = away ? -side : side;
      for (const Triangle& t : file.triangles) EXPECT_NEAR(file.geometric_normal(t).z(), expected, 1e-5f);
      for (const Vertex& v : file.vertices) EXPECT_NEAR(v.normal[2], expected, 1e-5f);
    }
  }
}

TEST(Patch, the_second_patch_of_a_part_refers_to_its_own_vertices) {
  Part part{"two.ply", {plane(), plane()}};
  part.patches[1].at = [](float u, float v, float) { return Surfel{{u, v, 5.0f}, Vec3::Ones()}; };
  KeptFile file;
  ASSERT_TRUE(write_part(part, file, always).has_value());
  for (std::size_t i = 0; i < file.triangles.size(); ++i) {
    const float z = i < 48 ? 0.0f : 5.0f;
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(file.corner(file.triangles[i], k).z(), z);
  }
}

TEST(Patch, a_patch_collapsed_to_a_point_has_unit_normals) {
  Part part{"point.ply", {plane()}};
  part.patches[0].at = [](float, float, float) { return Surfel{Vec3::Ones(), Vec3::Ones()}; };
  KeptFile file;
  ASSERT_TRUE(write_part(part, file, always).has_value());
  for (const Vertex& v : file.vertices) EXPECT_NEAR(Vec3(v.normal.data()).norm(), 1.0f, 1e-6f);
}

TEST(Patch, cancels_between_rows) {
  int calls = 0;
  KeptFile file;
  const Status status = write_part({"plane.ply", {plane()}}, file, [&](std::uint64_t) { return ++calls < 2; });
  ASSERT_FALSE(status.has_value());
  EXPECT_EQ(status.error().code(), ErrorCode::kUnavailable);
  EXPECT_EQ(file.vertices.size(), 18u);
}

TEST(ShareTriangles, gives_more_to_the_denser_patch_and_refuses_too_few) {
  std::vector<Part> parts = {{"a.ply", {plane()}}, {"b.ply", {plane()}}};
  parts[1].patches[0].density = 2.0f;
  ASSERT_TRUE(share_triangles(parts, 100'000).has_value());
  const double ratio =
      static_cast<double>(parts[1].counts().triangles) / static_cast<double>(parts[0].counts().triangles);
  EXPECT_NEAR(ratio, 4.0, 0.1);
  EXPECT_LE(parts[0].counts().triangles + parts[1].counts().triangles, 100'000u);
  EXPECT_GE(parts[0].counts().triangles + parts[1].counts().triangles, 98'000u);
  EXPECT_FALSE(share_triangles(parts, 10).has_value());
}

Sculpture ball(float radius) {
  Sculpture s;
  s.distance = [radius](const Vec3& p) { return sphere(p, Vec3::Zero(), radius); };
  s.colour = [](const Vec3&, float) { return Vec3::Ones(); };
  s.from = {0.0f, -0.01f, 0.0f};
  s.to = {0.0f, 0.01f, 0.0f};
  s.reach = 2.0f;
  s.girth = 3.0f;
  return s;
}

TEST(Sculpture, a_ball_has_no_seam_and_faces_outwards) {
  const Pose pose = standing_at({1.0f, 2.0f, 3.0f}, 0.7f, 2.0f);
  Part part{"ball.ply", {wrapped(ball(0.5f), pose, 1.0f)}};
  part.patches[0].columns = 40;
  part.patches[0].rows = 30;
  KeptFile file;
  ASSERT_TRUE(write_part(part, file, always).has_value());
  for (const Vertex& v : file.vertices) {
    const Vec3 out = Vec3(v.position.data()) - pose.position;
    EXPECT_NEAR(out.norm(), 1.0f, 2e-3f);
    EXPECT_GT(out.normalized().dot(Vec3(v.normal.data())), 0.9f);
  }
  for (std::size_t row = 0; row <= 30; ++row) {
    EXPECT_EQ(file.vertices[row * 41].position, file.vertices[row * 41 + 40].position);
    EXPECT_EQ(file.vertices[row * 41].normal, file.vertices[row * 41 + 40].normal);
  }
}

TEST(Sculpture, relief_moves_the_surface_outwards) {
  Sculpture s = ball(0.5f);
  s.relief = [](const Vec3& p, float) { return p.y() > 0.0f ? 0.1f : 0.0f; };
  const Patch patch = wrapped(s, Pose{}, 1.0f);
  EXPECT_NEAR(patch.at(0.3f, 0.9f, 0.01f).position.norm(), 0.6f, 2e-3f);
  EXPECT_NEAR(patch.at(0.3f, 0.1f, 0.01f).position.norm(), 0.5f, 2e-3f);
}

TEST(Solid, distances_are_zero_on_the_surface_and_blends_stay_between) {
  EXPECT_NEAR(ellipsoid({0.0f, 2.0f, 0.0f}, Vec3::Zero(), {1.0f, 2.0f, 3.0f}), 0.0f, 1e-5f);
  EXPECT_LT(ellipsoid(Vec3::Zero(), Vec3::Zero(), {1.0f, 2.0f, 3.0f}), 0.0f);
  EXPECT_NEAR(limb({0.0f, 1.5f, 0.0f}, Vec3::Zero(), 0.3f, Vec3::UnitY(), 0.5f), 0.0f, 1e-5f);
  EXPECT_NEAR(rounded_box({2.0f, 0.0f, 0.0f}, Vec3::Zero(), Vec3::Ones(), 0.2f), 1.0f, 1e-5f);
  for (float a = -1.0f; a < 1.0f; a += 0.13f) {
    for (float b = -1.0f; b < 1.0f; b += 0.17f) {
      EXPECT_LE(blend(a, b, 0.2f), std::min(a, b));
      EXPECT_GE(blend(a, b, 0.2f), std::min(a, b) - 0.05f - 1e-6f);
      EXPECT_GE(carve(a, b, 0.2f), std::max(a, -b));
    }
  }
}

}  // namespace
}  // namespace cyclorama::generator
