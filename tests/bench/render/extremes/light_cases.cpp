// SPDX-License-Identifier: Apache-2.0
/// Lights, and the sampling of their light.
#include <cmath>
#include <numbers>
#include <random>

#include "tests/bench/render/extremes/extreme_shapes.h"
#include "tests/bench/render/extremes/picture_case.h"

namespace cyclorama {
namespace {

const Eigen::Vector3d kEye(0.0, 1.0, 2.0);

PictureCase with(std::string name, void (*change)(ExtremePicture* picture)) {
  return {std::move(name), [change](const std::filesystem::path&) -> Result<ExtremePicture> {
            ExtremePicture picture{open_ground(), view_around(kEye)};
            change(&picture);
            return picture;
          }};
}

void no_area(ExtremePicture* picture) {
  scene::Scene& scene = picture->scene;
  scene::Mesh line = square(1.0);
  for (auto& p : line.positions) p = {p[0], 1.0f, 0.0f};
  scene::Material glowing = plain_material();
  glowing.emissive.setConstant(5.0f);
  put(scene, std::move(line), glowing);
  scene::Light thin = panel_at({0.0, 2.0, 0.0}, {0.0, -1.0, 0.0}, 1.0, 10.0f);
  thin.size_m.y() = 0.0;
  scene::Light disk = panel_at({1.0, 2.0, 0.0}, {0.0, -1.0, 0.0}, 1.0, 10.0f);
  disk.kind = scene::LightKind::kDisk;
  scene.model.lights = {thin,
                        disk,
                        lamp_at({0.0, 1.0, 0.0}, 3.0f, 0.0),
                        lamp_at({1.0, 1.0, 0.0}, 3.0f, 1e-30),
                        lamp_at({-1.0, 1.0, 0.0}, 3.0f, 1e-10),
                        panel_at({0.0, 2.0, 0.0}, {0.0, -1.0, 0.0}, 1e-15, 10.0f)};
  for (scene::Light& light : scene.model.lights) light.visible = true;
}

void bright_beside_dim(ExtremePicture* picture) {
  std::vector<scene::Light>& lights = picture->scene.model.lights;
  lights.push_back(lamp_at({0.0, 2.0, -2.0}, 1e10f, 0.01));
  lights.push_back(lamp_at({1.0, 2.0, -2.0}, 1e-3f, 0.01));
  lights.push_back(lamp_at({-1.0, 1.0, 0.0}, 1e-3f, 0.0));
  lights.push_back(panel_at({2.0, 1.0, -1.0}, {-1.0, 0.0, 1.0}, 0.2, 1e-3f));
  lights.push_back(panel_at({-2.0, 1.0, -1.0}, {1.0, 0.0, 1.0}, 0.2, 1e10f));
  lights[3].visible = lights[4].visible = false;  // Their backs are black.
}

void overflowing(ExtremePicture* picture) {
  scene::Material glowing = plain_material();
  glowing.emissive.setConstant(1e35f);
  put(picture->scene, ball(0.2, 8, true), glowing, Eigen::Affine3d(Eigen::Translation3d(1.0, 0.5, 0.0)));
  picture->scene.model.lights.push_back(lamp_at({-1.0, 1.0, 0.0}, 1e38f, 0.05));
}

void ten_thousand(ExtremePicture* picture) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-5.0, 5.0);
  for (int i = 0; i < 10'000; ++i) {
    const double x = place(random), z = place(random);
    scene::Light light =
        lamp_at({x, 0.01 + 3.0 * (i % 100) / 100.0, z}, i % 1000 == 0 ? 1.0f : 1e-4f, i % 2 == 0 ? 0.01 : 0.0);
    if (i % 5 == 0) {
      light = panel_at(light.position, {0.0, -1.0, 0.1}, 0.02, 1.0f);
      light.visible = false;
    }
    picture->scene.model.lights.push_back(light);
  }
}

/// Distances from a millimetre to a hundred thousand kilometres; enough lights for a tree.
void near_and_very_far(ExtremePicture* picture) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> angle(0.0, 2.0 * std::numbers::pi);
  for (int i = 0; i < 200; ++i) {
    const double distance = std::pow(10.0, -3.0 + 11.0 * i / 199.0);
    const double a = angle(random);
    picture->scene.model.lights.push_back(lamp_at({distance * std::cos(a), 0.5 * distance, distance * std::sin(a)},
                                                  static_cast<float>(0.01 * distance * distance),
                                                  i % 2 == 0 ? 0.01 * distance : 0.0));
  }
}

void all_glows(ExtremePicture* picture) {
  for (scene::Material& material : picture->scene.model.materials) material.emissive = {0.5f, 0.4f, 0.3f};
  scene::Material glowing = plain_material();
  glowing.emissive.setConstant(1e-3f);
  glowing.double_sided = true;
  for (int i = 0; i < 20; ++i) {
    put(picture->scene, ball(0.3, 8, i % 2 == 0), glowing,
        Eigen::Affine3d(Eigen::Translation3d(0.2 * i - 2.0, 0.3, 0.0)));
  }
}

void lights_on_surfaces(ExtremePicture* picture) {
  std::vector<scene::Light>& lights = picture->scene.model.lights;
  lights.push_back(lamp_at({0.0, 0.0, 0.0}, 1e3f, 0.0));
  lights.push_back(lamp_at({1.0, 0.1, 0.0}, 1.0f, 0.1));   // Touches the floor.
  lights.push_back(lamp_at({-1.0, 0.0, 0.0}, 1.0f, 0.1));  // Half below the floor.
  lights.push_back(panel_at({2.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, 0.5, 1.0f));
  lights.push_back(panel_at({-2.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, 0.5, 1.0f));
  lights.back().kind = scene::LightKind::kDisk;
  lights.back().radius_m = 0.25;
  lights.push_back(lamp_at({0.0, 1.0, -1.0}, 1e3f, 0.0));  // At a vertex of the ball.
  scene::Material glowing = plain_material();
  glowing.emissive.setConstant(2.0f);
  put(picture->scene, square(1.0), glowing, Eigen::Affine3d(Eigen::Translation3d(0.0, 0.0, 2.0)));
}

void eye_in_a_lamp(ExtremePicture* picture) { picture->scene.model.lights = {lamp_at(kEye, 5.0f, 0.5)}; }
void eye_in_a_point(ExtremePicture* picture) { picture->scene.model.lights = {lamp_at(kEye, 5.0f, 0.0)}; }
void eye_on_a_panel(ExtremePicture* picture) {
  picture->scene.model.lights = {panel_at(kEye, {0.0, 0.0, -1.0}, 1.0, 5.0f)};
}

/// A light at the pole of spherical coordinates, where azimuths coincide.
void suns(ExtremePicture* picture) {
  for (const double tangent : {0.0, 1e-10, 0.01, 1e6}) {
    scene::Light sun;
    sun.kind = scene::LightKind::kDirectional;
    sun.radius_m = tangent;
    sun.intensity.setConstant(tangent > 1.0 ? 1e-3f : 1e5f);
    picture->scene.model.lights.push_back(sun);
  }
}

void black_environment(ExtremePicture* picture) {
  picture->scene.environment =
      std::make_shared<const scene::EnvironmentMap>(scene::EnvironmentMap{RadianceImage(8, 4), 0.0f, 1.0f});
  picture->scene.ambient.setConstant(0.1f);
  // Closed, because the surroundings are black.
  put(picture->scene, block({12.0, 8.0, 12.0}), plain_material());
}

void one_blinding_texel(ExtremePicture* picture) {
  RadianceImage pixels(64, 32);
  for (float& value : pixels.data()) value = 1e-3f;
  *pixels.at(20, 5) = 1e10f;
  picture->scene.environment =
      std::make_shared<const scene::EnvironmentMap>(scene::EnvironmentMap{std::move(pixels), 0.3f, 1.0f});
}

void one_texel_environment(ExtremePicture* picture) {
  RadianceImage pixels(1, 1);
  for (float& value : pixels.data()) value = 0.5f;
  picture->scene.environment =
      std::make_shared<const scene::EnvironmentMap>(scene::EnvironmentMap{std::move(pixels), 0.0f, 1.0f});
}

void exposed(ExtremePicture* picture, double exposure) {
  picture->scene.exposure = exposure;
  picture->scene.model.lights.push_back(lamp_at({0.0, 2.0, 0.0}, 1e10f, 0.1));
  picture->view.quality.firefly_limit = 10.0f;
}

void limited_and_adaptive(ExtremePicture* picture) {
  bright_beside_dim(picture);
  picture->view.quality.samples = 64;
  picture->view.quality.adaptive_error = 1e-6f;
  picture->view.quality.firefly_limit = 1e-6f;
}

}  // namespace

std::vector<PictureCase> light_cases() {
  return {with("lights without an area", no_area),
          with("a light of 1e10 beside ones of 1e-3", bright_beside_dim),
          with("lights of 1e35 and 1e38", overflowing),
          with("10000 lights", ten_thousand),
          with("200 lights from 1 mm to 1e8 m away", near_and_very_far),
          with("everything glows", all_glows),
          with("lights exactly on surfaces", lights_on_surfaces),
          with("eye inside a lamp", eye_in_a_lamp),
          with("eye in a point light", eye_in_a_point),
          with("eye on a panel", eye_on_a_panel),
          with("suns of no width and of all the sky", suns),
          with("empty environment", black_environment),
          with("one texel of 1e10 in a dark environment", one_blinding_texel),
          with("environment of one texel", one_texel_environment),
          with("exposure 1e-30", [](ExtremePicture* picture) { exposed(picture, 1e-30); }),
          with("exposure 1e-6", [](ExtremePicture* picture) { exposed(picture, 1e-6); }),
          with("exposure 1e6", [](ExtremePicture* picture) { exposed(picture, 1e6); }),
          with("exposure 1e30", [](ExtremePicture* picture) { exposed(picture, 1e30); }),
          with("firefly limit 1e-6, adaptive error 1e-6", limited_and_adaptive)};
}

}  // namespace cyclorama
