// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/found_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "common/image/colour.h"
#include "renderfarm/scene/environment_file.h"
#include "renderfarm/scene/places.h"

namespace cyclorama::scene {
namespace {

/// Returns the irradiance from `light` on a surface at `p` that faces the light.
Eigen::Vector3d irradiance(const Light& light, const Eigen::Vector3d& p) {
  Eigen::Vector3d intensity = light.intensity.cast<double>();
  if (light.kind == LightKind::kDirectional) return intensity;
  const Eigen::Vector3d away = p - light.position;
  const double distance2 = std::max(away.squaredNorm(), 1e-4);
  if (light.range_m > 0.0 && distance2 > light.range_m * light.range_m) return Eigen::Vector3d::Zero();
  const double cosine = away.normalized().dot(light.direction);
  if (is_flat(light.kind)) {
    const double area = area_of(light);
    return intensity * (std::max(0.0, cosine) * area / (distance2 + area / std::numbers::pi));
  }
  if (light.kind == LightKind::kSpot && cosine < std::cos(light.outer_cone_rad)) return Eigen::Vector3d::Zero();
  return intensity / distance2;
}

double luminance(double r, double g, double b) { return 0.2126 * r + 0.7152 * g + 0.0722 * b; }

/// Returns the mean luminance of up to kSamples colours in sRGB codes.
template <typename At>
double mean_luminance(std::size_t count, const At& at) {
  constexpr std::size_t kSamples = 4096;
  if (count == 0) return 1.0;
  const std::size_t stride = count / kSamples + 1;
  double sum = 0.0;
  std::size_t samples = 0;
  for (std::size_t i = 0; i < count; i += stride, ++samples) {
    const std::uint8_t* const c = at(i);
    const auto linear = [](std::uint8_t code) { return double{srgb_to_linear(static_cast<float>(code) / 255.0f)}; };
    sum += luminance(linear(c[0]), linear(c[1]), linear(c[2]));
  }
  return sum / static_cast<double>(samples);
}

/// Returns twice the area of a placed mesh, estimated from some of its triangles.
double area_of(const Mesh& mesh, const Eigen::Matrix3d& linear) {
  constexpr std::size_t kSamples = 4096;
  const std::size_t stride = mesh.triangles.size() / kSamples + 1;
  double sum = 0.0;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += stride) {
    const auto corner = [&](std::size_t k) {
      return Eigen::Vector3d(
          Eigen::Map<const Eigen::Vector3f>(mesh.positions[mesh.triangles[i][k]].data()).cast<double>());
    };
    sum += (linear * (corner(1) - corner(0))).cross(linear * (corner(2) - corner(0))).norm();
  }
  return sum * static_cast<double>(stride);
}

/// Returns a factor for the lamps of a room. It gives the room the brightness that a factor of 1 gives a grey room
/// (albedo 0.5). Light reaches the eye after one or more reflections.
double strength_for(double albedo, int bounces) {
  constexpr double kGrey = 0.5;
  constexpr double kWeakest = 0.2;
  constexpr double kStrongest = 2.5;
  const auto brightness = [&](double part) {
    double sum = part;
    double light = part;
    for (int i = 0; i < std::min(bounces, 8); ++i) sum += light *= part;
    return sum;
  };
  return std::clamp(brightness(kGrey) / std::max(brightness(albedo), 1e-3), kWeakest, kStrongest);
}

}  // namespace

double mean_albedo(const Model& model) {
  std::vector<double> of_texture(model.textures.size(), -1.0);
  double sum = 0.0;
  double areas = 0.0;
  for (const Instance& instance : model.instances) {
    const Mesh& mesh = model.meshes[static_cast<std::size_t>(instance.mesh)];
    const Material& material = model.materials[static_cast<std::size_t>(mesh.material)];
    double albedo =
        luminance(double{material.base_colour[0]}, double{material.base_colour[1]}, double{material.base_colour[2]});
    if (const int texture = material.base_colour_texture.texture; texture >= 0) {
      double& known = of_texture[static_cast<std::size_t>(texture)];
      const std::span<const std::uint8_t> texels = model.textures[static_cast<std::size_t>(texture)].pixels.data();
      if (known < 0.0) known = mean_luminance(texels.size() / 4, [&](std::size_t i) { return &texels[4 * i]; });
      albedo *= known;
    }
    albedo *= mean_luminance(mesh.colours.size(), [&](std::size_t i) { return mesh.colours[i].data(); });
    const double area = area_of(mesh, instance.T_model_mesh.linear());
    sum += area * albedo;
    areas += area;
  }
  return areas > 0.0 && std::isfinite(sum) ? std::clamp(sum / areas, 0.0, 1.0) : 1.0;
}

void add_light(const FoundSettings& found, Scene* scene) {
  if (found.kind == SceneKind::kRoom) {
    const double reach = std::max(0.6 * found.view_m, 0.5);
    const double strength = strength_for(mean_albedo(scene->model), scene->bounces);
    const auto candela = static_cast<float>(3.0 * strength * reach * reach);
    scene->eye_lamp.setConstant(0.4f * candela);
    scene->ambient.setConstant(static_cast<float>(0.08 * strength));
    // Keeps the lamp well below a low ceiling and limits its light there; otherwise the white spot above the lamp would
    // dominate.
    constexpr double kMinDropM = 0.8;
    constexpr double kBrightestLux = 4.0;
    const double drop = std::max(0.5 * found.ceiling_m, kMinDropM);
    Light hanging;  // Casts shadows that show shapes; a lamp at the eye casts none.
    hanging.name = "hanging";
    hanging.position = found.eye + (found.ceiling_m - drop) * Eigen::Vector3d::UnitY() +
                       (0.5 * found.free_m) * ahead(found.heading_rad - 0.5 * std::numbers::pi);
    hanging.intensity.setConstant(std::min(0.6f * candela, static_cast<float>(kBrightestLux * strength * drop * drop)));
    hanging.radius_m = std::min({0.1, 0.2 * found.ceiling_m, 0.2 * found.free_m});
    scene->model.lights.push_back(std::move(hanging));
    return;
  }
  scene->sky = {Eigen::Vector3f::Constant(0.45f), Eigen::Vector3f::Constant(0.2f), Eigen::Vector3f::Constant(0.1f)};
  Light key;  // Shines from the visitor's upper left, as is usual in paintings.
  key.name = "key";
  key.kind = LightKind::kDirectional;
  key.direction = (0.5 * ahead(found.heading_rad + 0.5 * std::numbers::pi) + 0.6 * ahead(found.heading_rad) -
                   0.7 * Eigen::Vector3d::UnitY())
                      .normalized();
  key.intensity.setConstant(2.2f);
  key.radius_m = 0.05;
  scene->model.lights.push_back(std::move(key));
}

void add_shadow_light(const FoundSettings& found, Scene* scene) {
  // Share of white, because in reality areas that no lamp reaches directly are not black.
  constexpr float kShadow = 0.04f;
  const Eigen::Vector3f light = Eigen::Vector3f::Constant(kShadow / static_cast<float>(scene->exposure));
  if (found.kind == SceneKind::kObject && scene->environment == nullptr) {
    scene->sky = {light, light, light};
  } else {
    scene->ambient = light;
  }
}

double find_exposure(const FoundSettings& found, const Scene& scene) {
  constexpr double kMiddle = 0.25;  // Radiance of a surface that reflects half of its light.
  constexpr int kSamples = 256;
  Eigen::Vector3d from_all_around = Eigen::Vector3d::Zero();
  if (scene.environment) from_all_around = std::numbers::pi * mean_radiance(*scene.environment).cast<double>();
  std::vector<double> levels;
  for (int i = 0; i < kSamples; ++i) {
    // Samples lie on a spiral around the eye, at the distances of walls and objects.
    const double angle = 2.399963 * i;
    const double distance = found.view_m * std::sqrt((i + 0.5) / kSamples);
    const double height = (i % 5 - 2) * 0.2 * std::min(found.view_m, 3.0);
    const Eigen::Vector3d p = found.eye + distance * ahead(angle) + height * Eigen::Vector3d::UnitY();
    Eigen::Vector3d sum = from_all_around;
    // Half of the irradiance on a surface facing the light.
    for (const Light& light : scene.model.lights) sum += 0.5 * irradiance(light, p);
    levels.push_back(sum.dot(Eigen::Vector3d(0.2126, 0.7152, 0.0722)));
  }
  std::nth_element(levels.begin(), levels.begin() + kSamples / 2, levels.end());
  const double radiance = 0.5 * levels[kSamples / 2] / std::numbers::pi;
  if (!(radiance > 1e-9)) return 1.0;
  return std::clamp(kMiddle / radiance, 1e-6, 1e6);
}

}  // namespace cyclorama::scene
