// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/surface.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "renderfarm/render/accelerator.h"
#include "renderfarm/render/bake.h"
#include "renderfarm/render/ray_queue.h"
#include "tests/data_sets/simple_scenes.h"

namespace cyclorama::render {
namespace {

/// A scene with its BVH, for tracing individual rays.
struct Traced {
  explicit Traced(scene::Scene s) : scene(std::move(s)) {
    auto built = Accelerator::build(scene, 1, nullptr, std::nullopt, &traced);
    EXPECT_TRUE(built.has_value());
    accelerator = *std::move(built);
  }
  scene::Scene scene;
  TraceScene traced;
  std::unique_ptr<Accelerator> accelerator;
};

constexpr float kFar = std::numeric_limits<float>::infinity();

/// Returns the hit of a single ray.
RTCHit nearest(const Traced& t, const Vec3& origin, const Vec3& direction) {
  const auto rays = std::make_unique<RayQueue<RTCRayHit16>>();
  rays->add(origin, direction, kFar, 0);
  trace_nearest(t.traced.top, Coherence::kIncoherent, *rays);
  return rays->hit(0);
}

bool hits_anything(const Traced& t, const Vec3& origin, const Vec3& direction) {
  const auto rays = std::make_unique<RayQueue<RTCRay16>>();
  rays->add(origin, direction, kFar, 0);
  trace_any(t.traced.top, *rays);
  return rays->distance(0) < 0.0f;
}

/// Traces rays from inside a closed sphere. Each must hit it. A second ray from the hit must hit the sphere again if it
/// points inwards (no leak), but not the same triangle (no self-hit); if it points outwards, it must hit nothing.
void expect_tight(const Traced& t, const Vec3& centre, int rays) {
  std::mt19937 random(9);
  std::normal_distribution<float> normal;
  int missed = 0, self_hits = 0, leaks = 0, inside_out = 0;
  for (int i = 0; i < rays; ++i) {
    const Vec3 direction = Vec3(normal(random), normal(random), normal(random)).normalized();
    const RTCHit hit = nearest(t, centre, direction);
    if (hit.geomID == RTC_INVALID_GEOMETRY_ID) {
      ++missed;
      continue;
    }
    const SurfacePoint point = surface_at(triangle_at(t.traced, hit), direction);
    const Vec3 onward =
        from_frame_of(point.facing, cosine_hemisphere({std::abs(std::sin(static_cast<float>(i))), 0.3f}));
    const RTCHit next = nearest(t, start_off_surface(point, point.facing), onward);
    if (next.geomID == RTC_INVALID_GEOMETRY_ID) {
      ++leaks;
    } else if (next.primID == hit.primID && next.instID[0] == hit.instID[0]) {
      ++self_hits;
    }
    if (hits_anything(t, start_off_surface(point, -point.facing), -onward)) ++inside_out;
  }
  EXPECT_EQ(missed, 0);
  EXPECT_EQ(self_hits, 0);
  EXPECT_EQ(leaks, 0);
  EXPECT_EQ(inside_out, 0);
}

/// A second object at the start eye keeps the render origin there while the sphere is `distance` away.
scene::Scene far_sphere(double distance, float radius, bool instanced) {
  scene::Mesh sphere = sphere_mesh(radius, 40);
  const Eigen::Vector3d place = Eigen::Vector3d(0.6, 0.48, 0.64) * distance;
  scene::Scene scene = scene_of(square_mesh(0.01f));
  add_mesh(scene, std::move(sphere), Eigen::Affine3d(Eigen::Translation3d(place)));
  if (instanced) scene.model.instances.push_back({1, Eigen::Affine3d(Eigen::Translation3d(-1000.0 - distance, 0, 0))});
  return scene;
}

TEST(Surface, a_closed_sphere_has_no_leak_and_no_self_hit_near_or_far) {
  for (const double distance : {100.0, 1e3, 1e4, 1.48e5}) {
    for (const bool instanced : {false, true}) {
      SCOPED_TRACE(testing::Message() << distance << " m away, " << (instanced ? "instanced" : "baked"));
      const Traced t(far_sphere(distance, 10.0f, instanced));
      const Vec3 centre = (Eigen::Vector3d(0.6, 0.48, 0.64) * distance).cast<float>();
      expect_tight(t, centre, 20000);
    }
  }
}

TEST(Surface, is_independent_of_the_scale) {
  for (const float radius : {1e-3f, 1.0f, 1e3f, 1e5f}) {
    SCOPED_TRACE(radius);
    const Traced t(scene_of(sphere_mesh(radius, 40)));
    expect_tight(t, Vec3::Zero(), 20000);
  }
}

TEST(Surface, a_rotated_and_stretched_instance_has_no_leak_either) {
  Eigen::Affine3d placed = Eigen::Affine3d(Eigen::Translation3d(30, -20, 10)) *
                           Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized()) *
                           Eigen::Scaling(3.0, 0.2, -1.0);
  scene::Scene scene = scene_of(sphere_mesh(1.0f, 40));
  scene.model.instances = {{0, placed}, {0, Eigen::Affine3d(Eigen::Translation3d(500, 0, 0))}};
  scene.bounds = Eigen::AlignedBox3d(Eigen::Vector3d(-500, -100, -100), Eigen::Vector3d(500, 100, 100));
  const Traced t(std::move(scene));
  expect_tight(t, placed.translation().cast<float>(), 20000);
}

TEST(Surface, baked_and_instanced_meshes_agree) {
  scene::Mesh sphere = sphere_mesh(1.0f, 20);
  for (const auto& p : sphere.positions) sphere.normals.push_back(p);
  sphere.origin = {5, 0, 0};
  const Eigen::Affine3d placed = Eigen::Affine3d(Eigen::Translation3d(1, 2, -3)) *
                                 Eigen::AngleAxisd(0.7, Eigen::Vector3d(3, 1, 2).normalized()) *
                                 Eigen::Scaling(-2.0, 0.5, 1.0);
  scene::Scene once = scene_of(sphere);
  once.model.instances = {{0, placed}};
  scene::Scene twice = once;
  twice.model.instances.push_back({0, Eigen::Affine3d(Eigen::Translation3d(0, 1000, 0))});
  const Traced a(std::move(once));
  const Traced b(std::move(twice));
  const Vec3 centre = (placed * Eigen::Vector3d(5, 0, 0) - render_origin(a.scene)).cast<float>();
  std::mt19937 random(4);
  std::normal_distribution<float> normal;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 direction = Vec3(normal(random), normal(random), normal(random)).normalized();
    SurfacePoint points[2];
    for (const auto& [traced, point] : {std::pair{&a, &points[0]}, std::pair{&b, &points[1]}}) {
      const RTCHit hit = nearest(*traced, centre, direction);
      ASSERT_NE(hit.geomID, RTC_INVALID_GEOMETRY_ID);
      *point = surface_at(triangle_at(traced->traced, hit), direction);
    }
    EXPECT_LT((points[0].position - points[1].position).norm(), 1e-4f);
    EXPECT_GT(points[0].facing.dot(points[1].facing), 0.99f);
    EXPECT_GT(points[0].normal.dot(points[1].normal), 0.99f);
  }
}

/// Triangles without area, normals without length and textures without extent could introduce NaN into scattering.
TEST(Surface, degenerate_triangles_give_finite_directions) {
  scene::Mesh mesh;
  mesh.positions = {{0, 0, 0},      {0, 0, 0},      {0, 0, 0},     {1, 0, 0},    {2, 0, 0},
                    {1e-38f, 0, 0}, {0, 1e-38f, 0}, {3e38f, 0, 0}, {0, 3e38f, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 4}, {0, 5, 6}, {0, 7, 8}};
  mesh.normals.assign(9, {0, 0, 0});
  mesh.texcoords[0].assign(9, {0.5f, 0.5f});
  scene::Scene scene = scene_of(std::move(mesh));
  scene.model.textures.emplace_back();
  scene.model.textures[0].pixels = RgbaImage(1, 1, 10);
  scene.model.materials[0].normal_texture.texture = 0;
  MipTextures textures;
  const SurfaceMaterial material = trace_material(scene.model, scene.model.materials[0], &textures);
  textures.build(1);
  SurfaceMesh traced = trace_mesh(scene.model.meshes[0]);
  traced.records = make_triangle_records(scene.model.meshes[0]);
  traced.material = &material;
  const Placement placement = place(traced, Eigen::Affine3d::Identity());
  Placement baked;
  baked.mesh = &traced;
  for (const Placement* const at : {&placement, static_cast<const Placement*>(&baked)}) {
    for (std::size_t i = 0; i < 4; ++i) {
      TriangleHit hit{&traced, at, scene.model.meshes[0].triangles[i], Vec3(0.2f, 0.3f, 0.5f), &traced.records[i], {}};
      const SurfacePoint point = surface_at(hit, Vec3(0, 0, -1));
      EXPECT_NEAR(point.facing.norm(), 1.0f, 1e-3f) << i;
      EXPECT_NEAR(point.normal.norm(), 1.0f, 1e-3f) << i;
      EXPECT_NEAR(mapped_normal(hit, point, {0.1f, 0.0f}).norm(), 1.0f, 1e-3f) << i;
      EXPECT_GE(point.facing.z(), 0.0f);
    }
  }
}

TEST(Bake, keeps_normals_outwards_under_reflection) {
  scene::Mesh sphere = sphere_mesh(1.0f, 10);
  for (const auto& p : sphere.positions) sphere.normals.push_back(p);
  bake(sphere, Eigen::Affine3d(Eigen::Scaling(-1.0, 1.0, 1.0)), Eigen::Vector3d::Zero());
  for (std::size_t i = 0; i < sphere.positions.size(); ++i) {
    EXPECT_GT(to_vec3(sphere.positions[i]).dot(to_vec3(sphere.normals[i])), 0.9f);
  }
  for (const auto& t : sphere.triangles) {
    const Vec3 a = to_vec3(sphere.positions[t[0]]), b = to_vec3(sphere.positions[t[1]]),
               c = to_vec3(sphere.positions[t[2]]);
    EXPECT_GT((b - a).cross(c - a).dot(a + b + c), 0.0f);
  }
}

TEST(Bake, large_coordinates_keep_their_millimetres) {
  scene::Mesh mesh = square_mesh(1.0f);
  mesh.origin = {4.5e6, 300.0, 5.2e6};
  bake(mesh, Eigen::Affine3d::Identity(), {4.5e6 + 0.001, 300.0, 5.2e6});
  EXPECT_NEAR(mesh.positions[0][0], -0.501f, 1e-6f);
  EXPECT_NEAR(mesh.positions[1][0], 0.499f, 1e-6f);
}

TEST(RenderOrigin, is_the_start_eye_if_it_is_in_the_scene) {
  scene::Scene scene = scene_of(square_mesh(2.0f));
  scene.info.start_eye = {0.5, 0, 0};
  EXPECT_EQ(render_origin(scene), Eigen::Vector3d(0.5, 0, 0));
  scene.info.start_eye = {50, 0, 0};
  EXPECT_EQ(render_origin(scene), Eigen::Vector3d::Zero());
  EXPECT_EQ(render_origin(scene::Scene{}), Eigen::Vector3d::Zero());
}

}  // namespace
}  // namespace cyclorama::render
