// SPDX-License-Identifier: Apache-2.0
/// Geometry, materials, textures, and positions of the eye.
#include <algorithm>
#include <cmath>
#include <random>
#include <string_view>

#include "common/base/file.h"
#include "tests/bench/render/extremes/extreme_shapes.h"
#include "tests/bench/render/extremes/picture_case.h"

namespace cyclorama {
namespace {

using Translation = Eigen::Translation3d;

ExtremePicture seen_from(scene::Scene scene, const Eigen::Vector3d& eye) {
  scene.info.start_eye = eye;
  return {std::move(scene), view_around(eye)};
}

PictureCase in_memory(std::string name, ExtremePicture (*make)()) {
  return {std::move(name), [make](const std::filesystem::path&) { return Result<ExtremePicture>(make()); }};
}

/// Triangles of decreasing width, down to zero; some with duplicate corners, some duplicated as a whole.
ExtremePicture slivers() {
  scene::Mesh mesh;
  std::mt19937 random(3);
  std::uniform_real_distribution<float> place(-1.0f, 1.0f);
  for (std::uint32_t i = 0; i < 2000; ++i) {
    const float width = i % 50 == 0 ? 0.0f : std::pow(10.0f, -static_cast<float>(i % 40));
    const float x = place(random), y = 1.0f + place(random), z = place(random) - 1.0f;
    mesh.positions.push_back({x, y, z});
    mesh.positions.push_back({x + 0.5f * place(random), y + place(random), z + place(random)});
    mesh.positions.push_back({x + width, y, z});
    mesh.triangles.push_back({3 * i, 3 * i + 1, i % 7 == 0 ? 3 * i : 3 * i + 2});
    if (i % 11 == 0) mesh.triangles.push_back(mesh.triangles.back());
  }
  mesh.texcoords[0].assign(mesh.positions.size(), {0.25f, 0.25f});  // Zero extent.
  mesh.normals.assign(mesh.positions.size(), {0.0f, 0.0f, 0.0f});
  scene::Scene scene = open_ground();
  scene.model.textures.emplace_back();
  scene.model.textures[0].pixels = RgbaImage(4, 4, 200);
  scene::Material material = plain_material();
  material.roughness = 0.2f;
  material.normal_texture.texture = 0;
  material.base_colour_texture.texture = 0;
  put(scene, std::move(mesh), material);
  return seen_from(std::move(scene), {0.0, 1.0, 2.0});
}

/// Invalid numbers come only from files; importers drop and note them.
Result<ExtremePicture> broken_file(const std::filesystem::path& scratch) {
  constexpr std::string_view kText =
      "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 5\nproperty list uchar int vertex_indices\nend_header\n"
      "-5 0 -5\n5 0 -5\n5 0 5\n-5 0 5\nnan 1 0\n0 inf 0\n1e30 1 1\n-5 0 -5\n"
      "3 0 2 1\n3 0 3 2\n3 0 1 4\n3 1 2 5\n3 2 3 6\n";
  const std::filesystem::path file = scratch / "broken.ply";
  TRY(write_file_atomically(file, kText));
  TRY_ASSIGN(scene::Scene scene, scene::load_scene(file, scene::ImportLimits{}, nullptr));
  const bool noted = std::ranges::any_of(scene.model.notes, [](const std::string& note) {
    return note.find("3 triangles have corners that are not finite") != std::string::npos;
  });
  if (!noted) return Error(ErrorCode::kBadData, "the triangles that are not finite are not noted");
  scene.sky = even_sky(0.3f);
  return seen_from(std::move(scene), {0.0, 1.0, 0.0});
}

/// A row of balls whose common material is modified by `change`.
ExtremePicture row_of_balls(int count, void (*change)(int ball, scene::Material* material)) {
  scene::Scene scene = open_ground();
  for (int i = 0; i < count; ++i) {
    scene::Material material = plain_material({0.9f, 0.8f, 0.7f});
    change(i, &material);
    put(scene, ball(0.3, 12, true), material, Eigen::Affine3d(Translation(0.7 * (i - 0.5 * (count - 1)), 0.3, 0.0)));
  }
  scene.model.lights = {lamp_at({1.0, 3.0, 2.0}, 5.0f, 0.05), panel_at({-2.0, 2.0, 0.0}, {1.0, -1.0, 0.0}, 0.5, 8.0f)};
  scene.model.lights[1].visible = false;  // Its back would be black.
  return seen_from(std::move(scene), {0.0, 0.8, 2.0});
}

ExtremePicture rough_and_smooth() {
  return row_of_balls(8, [](int i, scene::Material* material) {
    constexpr std::array kRoughness{0.0f, 1e-30f, 1e-6f, 1.0f};
    material->roughness = kRoughness[static_cast<std::size_t>(i) % kRoughness.size()];
    material->metallic = i < 4 ? 1.0f : 0.0f;
    material->clearcoat = i % 2 == 0 ? 1.0f : 0.0f;
    material->clearcoat_roughness = material->roughness;
  });
}

ExtremePicture odd_glass() {
  return row_of_balls(8, [](int i, scene::Material* material) {
    constexpr std::array kIor{1.0f, 1.0f + 1e-6f, 1.5f, scene::kMaxIor};
    material->ior = kIor[static_cast<std::size_t>(i) % kIor.size()];
    material->roughness = i < 4 ? 0.0f : 0.4f;
    material->transmission = 1.0f;
    material->thickness = i % 2 == 0 ? 1.0f : 0.0f;
    material->attenuation_colour = {0.9f, 0.5f, 0.5f};
    material->attenuation_distance = 0.5f;
  });
}

ExtremePicture tiny_and_huge_textures() {
  scene::Scene scene = open_ground();
  constexpr std::array<std::array<int, 2>, 4> kSizes{{{1, 1}, {16384, 16}, {3, 16384}, {16384, 1}}};
  for (std::size_t i = 0; i < kSizes.size(); ++i) {
    scene.model.textures.emplace_back();
    scene.model.textures.back().pixels = RgbaImage(kSizes[i][0], kSizes[i][1], 180);
    scene.model.textures.back().nearest = i % 2 == 1;
    for (const float repeats : {1.0f, 1e-6f, 1e7f}) {
      scene::Material material = plain_material();
      const auto texture = static_cast<int>(i);
      material.base_colour_texture.texture = texture;
      material.normal_texture.texture = texture;
      material.metallic_roughness_texture.texture = texture;
      material.metallic = 1.0f;
      const double x = static_cast<double>(i) - 1.5;
      put(scene, square(0.8, repeats), material,
          Translation(x, 0.2 + 0.3 * std::log10(static_cast<double>(repeats) + 1.0), -0.5) *
              Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()));
    }
  }
  return seen_from(std::move(scene), {0.0, 1.0, 2.0});
}

ExtremePicture white_for_ever() {
  scene::Scene scene;
  put(scene, block({4.0, 3.0, 4.0}), plain_material(Eigen::Vector3f::Ones()));
  scene.model.lights = {lamp_at({0.5, 0.5, -0.5}, 1.0f, 0.1)};
  ExtremePicture picture = seen_from(std::move(scene), Eigen::Vector3d::Zero());
  picture.view.quality.bounces = render::kMaxBounces;
  return picture;
}

/// A closed cabinet of mirrors, in which nothing absorbs paths.
ExtremePicture mirrors_all_around() {
  scene::Scene scene;
  scene::Material mirror = plain_material(Eigen::Vector3f::Ones());
  mirror.metallic = 1.0f;
  mirror.roughness = 0.0f;
  put(scene, block({4.0, 3.0, 4.0}), mirror);
  scene::Material glowing = plain_material();
  glowing.emissive.setConstant(1.0f);
  put(scene, ball(1.2, 12, true), glowing, Eigen::Affine3d(Translation(0.0, 0.0, -0.5)));
  // Ambient light is needed too, since a path ends sixteen mirrors away from the ball.
  scene.ambient.setConstant(0.2f);
  ExtremePicture picture = seen_from(std::move(scene), {0.0, 0.0, 1.2});
  picture.view.quality.bounces = render::kMaxBounces;
  return picture;
}

ExtremePicture many_veils() {
  scene::Scene scene = open_ground();
  scene::Material veil = plain_material();
  veil.base_colour.w() = 0.02f;
  veil.alpha_mode = scene::AlphaMode::kBlend;
  for (int i = 0; i < 300; ++i)
    put(scene, square(4.0), veil, Eigen::Affine3d(Translation(0.0, 0.003 * (i + 1), 0.0)));
  return seen_from(std::move(scene), {0.0, 1.5, 1.0});
}

ExtremePicture boundless_floor() {
  scene::Scene scene = open_ground();
  put(scene, square(1e8), plain_material(), Eigen::Affine3d(Translation(0.0, -0.1, 0.0)));
  put(scene, square(1e14), plain_material(), Eigen::Affine3d(Translation(0.0, -2.0, 0.0)));
  scene.model.lights = {lamp_at({0.0, 2.0, 0.0}, 3.0f, 0.0), lamp_at({1e6, 1e5, 0.0}, 1e10f, 1e3)};
  return seen_from(std::move(scene), {0.0, 1.0, 2.0});
}

/// Shared meshes whose instances flatten, mirror, shrink and enlarge them.
ExtremePicture odd_instances() {
  scene::Scene scene = open_ground();
  const Eigen::Affine3d first(Translation(0.0, 1.0, 0.0));
  put(scene, ball(0.2, 8, true), plain_material(), first);
  const int shared = static_cast<int>(scene.model.meshes.size()) - 1;
  for (const Eigen::Vector3d& scale : {Eigen::Vector3d(1, 0, 1), Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(-1, 1, 1),
                                       Eigen::Vector3d::Constant(1e-12).eval(), Eigen::Vector3d::Constant(1e6).eval(),
                                       Eigen::Vector3d(1e-6, 1e6, 1)}) {
    scene.model.instances.push_back({shared, first * Eigen::Scaling(scale)});
  }
  scene.ambient.setConstant(0.1f);  // The largest instance encloses everything else.
  return seen_from(std::move(scene), {0.0, 1.0, 2.0});
}

ExtremePicture eye_on_the_floor() { return seen_from(open_ground(), {1.0, 0.0, 1.0}); }
ExtremePicture eye_on_a_corner() { return seen_from(open_ground(), {5.0, 0.0, 5.0}); }

/// The eye is exactly on a vertex in float. Downwards it looks into the ball, which the sky's light does not reach.
ExtremePicture eye_on_a_ball() {
  scene::Scene scene = open_ground();
  scene.ambient.setConstant(0.1f);
  return seen_from(std::move(scene), {0.0, 1.0, -1.0});
}

}  // namespace

std::vector<PictureCase> surface_cases() {
  return {in_memory("slivers, triangles without area, doubles", slivers),
          {"vertices that are NaN or infinite, in a file", broken_file},
          in_memory("roughness 0, 1e-30, 1e-6, 1", rough_and_smooth),
          in_memory("index of refraction 1, 1.000001, 1e6", odd_glass),
          in_memory("textures of 1 and of 16384 texels", tiny_and_huge_textures),
          in_memory("albedo 1, 64 bounces", white_for_ever),
          in_memory("mirrors all around, 64 bounces", mirrors_all_around),
          in_memory("300 veils", many_veils),
          in_memory("floors of 1e8 and 1e14 m", boundless_floor),
          in_memory("flat, mirrored, tiny and huge instances", odd_instances),
          in_memory("eye on the floor", eye_on_the_floor),
          in_memory("eye on a corner", eye_on_a_corner),
          in_memory("eye on a vertex of a ball", eye_on_a_ball)};
}

}  // namespace cyclorama
