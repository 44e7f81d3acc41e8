// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/extremes/same_picture.h"

#include "renderfarm/quality/flip.h"
#include "tests/bench/render/extremes/extreme_shapes.h"

namespace cyclorama {
namespace {

constexpr double kRoomM = 6.0;

/// Contains every kind of object with a position or a length: baked and instanced meshes, coloured glass, all kinds of
/// lamps.
scene::Scene room(double scale, const Eigen::Vector3d& shift) {
  const auto at = [&](double x, double y, double z) {
    return Eigen::Vector3d(shift + scale * Eigen::Vector3d(x, y, z));
  };
  const auto moved = [&](double x, double y, double z) { return Eigen::Affine3d(Eigen::Translation3d(at(x, y, z))); };
  scene::Scene scene;
  scene::Mesh walls = block(Eigen::Vector3d(kRoomM, 3.0, kRoomM) * scale);
  walls.origin = at(0.0, 1.5, 0.0);
  put(scene, std::move(walls), plain_material({0.6f, 0.55f, 0.5f}));
  scene::Material metal = plain_material({0.9f, 0.7f, 0.4f});
  metal.metallic = 1.0f;
  metal.roughness = 0.3f;
  put(scene, ball(0.5 * scale, 24, true), metal, moved(-1.2, 0.5, -1.5));
  scene::Material glass = plain_material(Eigen::Vector3f::Ones());
  glass.roughness = 0.0f;
  glass.transmission = 1.0f;
  glass.thickness = 1.0f;
  glass.attenuation_colour = {0.4f, 0.8f, 0.9f};
  glass.attenuation_distance = static_cast<float>(scale);
  put(scene, ball(0.5 * scale, 24, true), glass, moved(1.2, 0.5, -1.5));
  put(scene, ball(0.3 * scale, 16, false), plain_material({0.3f, 0.5f, 0.3f}), moved(0.0, 0.3, -2.0));
  const int shared = static_cast<int>(scene.model.meshes.size()) - 1;
  scene.model.instances.push_back({shared, moved(0.0, 0.3, 2.0)});
  scene.model.instances.push_back({shared, moved(2.0, 0.3, 0.5)});
  const auto candela = [&](double of_room) { return static_cast<float>(of_room * scale * scale); };
  scene.model.lights = {panel_at(at(0.0, 2.9, 0.0), -Eigen::Vector3d::UnitY(), scale, 5.0f),
                        lamp_at(at(-2.0, 1.5, 1.0), candela(2.0), 0.1 * scale),
                        lamp_at(at(2.0, 2.0, -2.0), candela(1.0), 0.0)};
  scene.model.lights[2].range_m = 10.0 * scale;
  scene.info.start_eye = at(0.0, 1.5, 0.5);
  return scene;
}

Result<RgbImage> picture(double scale, const Eigen::Vector3d& shift, int width_px, int threads) {
  scene::Scene scene = room(scale, shift);
  render::PanoramaView view = view_around(scene.info.start_eye);
  view.panorama.width_px = width_px;
  view.panorama.height_px = width_px / 2;
  view.quality.samples = 16;
  TRY_ASSIGN(const std::unique_ptr<render::Renderer> renderer,
             render::Renderer::build(std::move(scene), threads, nullptr));
  RgbImage codes;
  renderer->render(view, {0, 0, view.panorama.width_px, view.panorama.height_px}, &codes, nullptr);
  return codes;
}

}  // namespace

Result<std::vector<SamePicture>> far_from_the_origin(const std::vector<double>& metres, int width_px, int threads) {
  TRY_ASSIGN(const RgbImage reference, picture(1.0, Eigen::Vector3d::Zero(), width_px, threads));
  std::vector<SamePicture> same;
  for (const double distance : metres) {
    TRY_ASSIGN(const RgbImage far,
               picture(1.0, Eigen::Vector3d(1.0, 0.1, -0.7).normalized() * distance, width_px, threads));
    TRY_ASSIGN(const quality::Flip difference, quality::flip(far, reference));
    same.push_back({distance, difference.mean});
  }
  return same;
}

Result<std::vector<SamePicture>> scaled(const std::vector<double>& metres, int width_px, int threads) {
  TRY_ASSIGN(const RgbImage reference, picture(1.0, Eigen::Vector3d::Zero(), width_px, threads));
  std::vector<SamePicture> same;
  for (const double length : metres) {
    TRY_ASSIGN(const RgbImage other, picture(length / kRoomM, Eigen::Vector3d::Zero(), width_px, threads));
    TRY_ASSIGN(const quality::Flip difference, quality::flip(other, reference));
    same.push_back({length, difference.mean});
  }
  return same;
}

}  // namespace cyclorama
