// SPDX-License-Identifier: Apache-2.0
/// Direct light of every lamp on every kind of surface, compared with sums over the lamp in double. The mean is the
/// same for light sampling, BSDF sampling and both combined by multiple importance sampling.
#include <gtest/gtest.h>

#include <numbers>
#include <string>
#include <vector>

#include "renderfarm/render/bsdf.h"
#include "renderfarm/render/lights/environment_light.h"
#include "renderfarm/render/requirements.h"
#include "tests/support/measured_light.h"

namespace cyclorama::render {
namespace {

using Eigen::Vector3d;

/// A part of a lamp as seen from the point on the floor.
struct Glimpse {
  Vector3d direction;
  double light = 0.0;  ///< Radiance times solid angle.
};

struct Lighting {
  std::string name;
  scene::Scene scene;  ///< Excludes the floor.
  std::vector<Glimpse> glimpses;
};

/// A parallelogram, divided into small ones; `keep(s, t)` selects them for s and t in [-1, 1].
template <typename Keep>
void see(const Vector3d& middle, const Vector3d& x, const Vector3d& y, double radiance, bool both_sides,
         const Keep& keep, std::vector<Glimpse>* ret) {
  constexpr int kSteps = 160;
  const Vector3d area = 4.0 * x.cross(y) / (kSteps * kSteps);
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const double s = (2.0 * i + 1.0) / kSteps - 1.0;
      const double t = (2.0 * j + 1.0) / kSteps - 1.0;
      const Vector3d place = middle + s * x + t * y;
      const double facing = -area.dot(place) / std::pow(place.norm(), 3.0);
      if (place.y() <= 0.0 || !keep(s, t) || (facing < 0.0 && !both_sides)) continue;
      ret->push_back({place.normalized(), radiance * std::abs(facing)});
    }
  }
}
bool everywhere(double, double) { return true; }
bool in_circle(double s, double t) { return s * s + t * t <= 1.0; }

/// A sphere's cap of directions.
void see_ball(const Vector3d& middle, double radius, double radiance, std::vector<Glimpse>* ret) {
  constexpr int kSteps = 160;
  const Vector3d axis = middle.normalized();
  const Vector3d across = axis.unitOrthogonal();
  const double min = std::sqrt(1.0 - radius * radius / middle.squaredNorm());
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const double z = min + (1.0 - min) * (i + 0.5) / kSteps;
      const double angle = 2.0 * std::numbers::pi * (j + 0.5) / kSteps;
      const double r = std::sqrt(1.0 - z * z);
      ret->push_back({z * axis + r * std::cos(angle) * across + r * std::sin(angle) * axis.cross(across),
                      radiance * 2.0 * std::numbers::pi * (1.0 - min) / (kSteps * kSteps)});
    }
  }
}

void see_environment(const scene::Scene& scene, std::vector<Glimpse>* ret) {
  constexpr int kSteps = 256;
  const EnvironmentLight environment(scene.sky, scene.environment);
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < 2 * kSteps; ++j) {
      const double y = (i + 0.5) / kSteps;
      const double angle = std::numbers::pi * (j + 0.5) / kSteps;
      const double r = std::sqrt(1.0 - y * y);
      const Vector3d direction(r * std::cos(angle), y, r * std::sin(angle));
      const auto radiance = static_cast<double>(environment.radiance(direction.cast<float>()).x());
      ret->push_back({direction, radiance * std::numbers::pi / (kSteps * kSteps)});
    }
  }
}

constexpr double kRadiance = 3.0;
const Vector3d kPlace(0.25, 1.0, -0.9);  // Approximate position at which a mirror on the floor would show it.

scene::Light flat_light(scene::LightKind kind, bool visible) {
  scene::Light light;
  light.kind = kind;
  light.position = kPlace;
  light.direction = Vector3d(-0.2, -1.0, 0.4).normalized();
  light.across = light.direction.unitOrthogonal();
  light.intensity = Eigen::Vector3f::Constant(static_cast<float>(kRadiance));
  light.size_m = {0.7, 0.4};
  light.radius_m = 0.3;
  light.visible = visible;
  return light;
}

Lighting rectangle(bool visible) {
  Lighting lit{"rectangle", {}, {}};
  const scene::Light light = flat_light(scene::LightKind::kRectangle, visible);
  lit.scene.model.lights = {light};
  const Vector3d up = light.direction.cross(light.across);
  see(light.position, 0.35 * light.across, 0.2 * up, kRadiance, false, everywhere, &lit.glimpses);
  return lit;
}

Lighting disk(bool visible) {
  Lighting lit{"disk", {}, {}};
  const scene::Light light = flat_light(scene::LightKind::kDisk, visible);
  lit.scene.model.lights = {light};
  const Vector3d up = light.direction.cross(light.across);
  see(light.position, 0.3 * light.across, 0.3 * up, kRadiance, false, in_circle, &lit.glimpses);
  return lit;
}

Lighting ball(bool visible) {
  Lighting lit{"ball", {}, {}};
  constexpr double kRadius = 0.3;
  scene::Light light = point_light(kPlace, static_cast<float>(kRadiance * std::numbers::pi * kRadius * kRadius));
  light.radius_m = kRadius;
  light.visible = visible;
  lit.scene.model.lights = {light};
  see_ball(kPlace, kRadius, kRadiance, &lit.glimpses);
  return lit;
}

/// An emissive square without reflection, with its front up, or down if turned by `turned`.
Lighting glowing_square(const std::string& name, const std::vector<Eigen::Affine3d>& places, bool double_sided) {
  Lighting lit{name, {}, {}};
  scene::Material glow = matte_material(Eigen::Vector3f::Zero());
  glow.emissive = Eigen::Vector3f::Constant(static_cast<float>(kRadiance));
  glow.double_sided = double_sided;
  lit.scene.model.materials.push_back(glow);
  add_mesh(lit.scene, square_mesh(2.0f, 0), places[0]);
  for (std::size_t i = 1; i < places.size(); ++i) lit.scene.model.instances.push_back({0, places[i]});
  for (const Eigen::Affine3d& place : places) {
    const Eigen::Matrix3d m = place.linear();
    // Rays see both sides; the front matters to light sampling alone.
    see(place.translation(), m.col(0), m.col(2), kRadiance, true, everywhere, &lit.glimpses);
  }
  return lit;
}

Eigen::Affine3d placed(const Vector3d& at, double turn_rad, const Vector3d& scale) {
  return Eigen::Translation3d(at) * Eigen::AngleAxisd(turn_rad, Vector3d(1.0, 0.0, 0.3).normalized()) *
         Eigen::Scaling(scale);
}

std::vector<Eigen::Affine3d> three_places() {
  return {placed(kPlace, std::numbers::pi + 0.3, {0.4, 1.0, 0.2}),
          placed({-1.0, 0.8, 0.3}, std::numbers::pi - 0.5, {-0.3, 1.0, 0.3}),  // A mirror image.
          placed({0.8, 1.5, 0.9}, std::numbers::pi + 0.6, {0.3, 1.0, -0.5})};
}

Lighting sky() {
  Lighting lit{"sky", {}, {}};
  lit.scene.sky.zenith.setConstant(2.0f);
  lit.scene.sky.horizon.setConstant(0.3f);
  see_environment(lit.scene, &lit.glimpses);
  return lit;
}

Lighting environment_map() {
  Lighting lit{"environment map", {}, {}};
  auto map = std::make_shared<scene::EnvironmentMap>();
  map->pixels = RadianceImage(16, 8, 0.5f);
  std::fill_n(map->pixels.at(8, 2), 3, 40.0f);  // A lamp, ahead and above.
  std::fill_n(map->pixels.at(3, 1), 3, 10.0f);
  map->rotation_rad = 0.2f;
  lit.scene.environment = map;
  see_environment(lit.scene, &lit.glimpses);
  return lit;
}

/// Lights of every kind at once: the probabilities of choosing them must be consistent.
Lighting all_of_them() {
  Lighting lit = rectangle(true);
  lit.name = "all";
  for (const Lighting& more : {ball(true), environment_map()}) {
    for (scene::Light light : more.scene.model.lights) {
      light.position = Vector3d(-0.8, 1.1, -0.4);
      lit.scene.model.lights.push_back(light);
    }
    if (more.scene.environment != nullptr) lit.scene.environment = more.scene.environment;
  }
  // The part of the environment hidden by the lamps is too large to ignore: only what they leave visible is counted.
  const scene::Light& front = lit.scene.model.lights[0];
  const Vector3d middle = lit.scene.model.lights[1].position;
  see_ball(middle, 0.3, kRadiance, &lit.glimpses);
  std::vector<Glimpse> far;
  see_environment(lit.scene, &far);
  const Vector3d up = front.direction.cross(front.across);
  for (const Glimpse& g : far) {
    const Vector3d at = g.direction * (front.position.dot(front.direction) / g.direction.dot(front.direction));
    const Vector3d in_plane = at - front.position;
    const bool behind_front =
        std::abs(in_plane.dot(front.across)) < 0.35 && std::abs(in_plane.dot(up)) < 0.2 && at.y() > 0.0;
    const bool behind_ball = g.direction.dot(middle) > std::sqrt(middle.squaredNorm() - 0.09);
    if (!behind_front && !behind_ball) lit.glimpses.push_back(g);
  }
  return lit;
}

scene::Material floor_material(float alpha) {
  if (alpha == 1.0f) return matte_material(Eigen::Vector3f::Constant(0.7f));
  scene::Material material = matte_material(Eigen::Vector3f::Constant(0.7f));
  material.metallic = 0.5f;
  material.roughness = std::sqrt(alpha);
  return material;
}

template <SurfaceLevel kLevel>
double sum_of(const std::vector<Glimpse>& glimpses, const scene::Material& material) {
  const Bsdf bsdf = make_bsdf(material, SurfaceTexels{}, false, kLevel);
  const Scattering<kLevel> scattering(bsdf, Vec3::UnitY(), Vec3(0.0f, 1.0f, 1.0f).normalized());
  double sum = 0.0;
  for (const Glimpse& g : glimpses) {
    sum += g.light * static_cast<double>(scattering.evaluate(g.direction.cast<float>()).x());
  }
  return sum;
}

double expected_light(const std::vector<Glimpse>& glimpses, const scene::Material& material) {
  if (surface_level_of(material, {}) == SurfaceLevel::kMatte) return sum_of<SurfaceLevel::kMatte>(glimpses, material);
  return sum_of<SurfaceLevel::kGlossy>(glimpses, material);
}

void expect_light_of(const Lighting& lit) {
  for (const float alpha : {0.05f, 0.3f, 0.8f, 1.0f}) {
    scene::Scene scene = lit.scene;
    const scene::Material material = floor_material(alpha);
    scene.model.materials.push_back(material);
    add_mesh(scene, square_mesh(0.01f, static_cast<int>(scene.model.materials.size()) - 1));
    const double expected = expected_light(lit.glimpses, material);
    const auto renderer = built(std::move(scene));
    for (const auto& [bounces, light_samples] : {std::pair{0, 1}, std::pair{1, 1}, std::pair{1, 3}, std::pair{1, 16}}) {
      SCOPED_TRACE(lit.name + ", alpha " + std::to_string(alpha) + ", bounces " + std::to_string(bounces) +
                   ", light samples " + std::to_string(light_samples));
      PanoramaView view = view_of_one_point();
      view.quality.bounces = bounces;
      view.quality.light_samples = light_samples;
      const MeasuredLight light = measured(*renderer, view);
      expect_light(light, expected);
      EXPECT_LT(light.error, 0.03 * expected) << "too noisy to find anything";
    }
  }
}

TEST(PathTracerLights, a_rectangle_gives_its_integral) {
  expect_light_of(rectangle(true));
  expect_light_of(rectangle(false));
}
TEST(PathTracerLights, a_disk_gives_its_integral) {
  expect_light_of(disk(true));
  expect_light_of(disk(false));
}
TEST(PathTracerLights, a_sphere_gives_its_integral) {
  expect_light_of(ball(true));
  expect_light_of(ball(false));
}
TEST(PathTracerLights, a_glowing_mesh_gives_its_integral) {
  const std::vector<Eigen::Affine3d> facing_down = {three_places()[0]};
  expect_light_of(glowing_square("one-sided", facing_down, false));
  expect_light_of(glowing_square("double-sided", facing_down, true));
}
TEST(PathTracerLights, glowing_instances_give_their_integral) {
  expect_light_of(glowing_square("one-sided instances", three_places(), false));
  expect_light_of(glowing_square("double-sided instances", three_places(), true));
}
TEST(PathTracerLights, a_sky_gives_its_integral) { expect_light_of(sky()); }
TEST(PathTracerLights, an_environment_map_gives_its_integral) { expect_light_of(environment_map()); }
TEST(PathTracerLights, lights_of_all_kinds_together_give_their_integral) { expect_light_of(all_of_them()); }

/// Light sampling covers the front only; scattered rays see the back emit.
TEST(PathTracerLights, the_back_of_a_glowing_mesh_is_found_by_scattering) {
  const Lighting lit = glowing_square("from behind", {placed(kPlace, 0.3, {0.4, 1.0, 0.4})}, false);
  scene::Scene scene = lit.scene;
  const scene::Material material = floor_material(1.0f);
  scene.model.materials.push_back(material);
  add_mesh(scene, square_mesh(0.01f, 1));
  const auto renderer = built(std::move(scene));
  PanoramaView view = view_of_one_point();
  view.quality.bounces = 1;
  view.quality.samples = 16;
  expect_light(measured(*renderer, view), expected_light(lit.glimpses, material));
}

}  // namespace
}  // namespace cyclorama::render
