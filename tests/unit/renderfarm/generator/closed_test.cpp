// SPDX-License-Identifier: Apache-2.0
/// Checks with rays that the chamber is closed, by the renderer that will show it.
#include <gtest/gtest.h>

#include <numbers>

#include "renderfarm/generator/chamber.h"
#include "renderfarm/generator/package.h"
#include "renderfarm/render/renderer.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama::generator {
namespace {

namespace fs = std::filesystem;

class ClosedGrotto : public testing::TestWithParam<std::uint64_t> {
 protected:
  void SetUp() override {
    std::string name = testing::TempDir() + "closed.XXXXXX";
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    parent_ = name;
    const PackageOrder order{.triangles = GetParam(), .seed = 2, .folder = parent_ / "grotto", .threads = 2};
    ASSERT_TRUE(write_package(order, [](double) { return true; }).has_value());
    auto scene = scene::load_scene(order.folder, scene::ImportLimits{}, nullptr);
    ASSERT_TRUE(scene.has_value()) << scene.error().message();
    scene_ = std::move(*scene);
  }
  void TearDown() override { fs::remove_all(parent_); }

  fs::path parent_;
  scene::Scene scene_;
};

TEST_P(ClosedGrotto, shows_no_sky_from_anywhere_inside) {
  // Only the sky emits light, so any light in a picture came through a hole.
  scene_.model.lights.clear();
  scene_.ambient.setZero();
  scene_.eye_lamp = Eigen::Vector3f::Constant(1e-9f);  // Otherwise a scene without light would be given a lamp.
  scene_.sky.zenith = scene_.sky.horizon = scene_.sky.ground = Eigen::Vector3f::Constant(100.0f);
  const auto renderer = render::Renderer::build(std::move(scene_), 2, nullptr);
  ASSERT_TRUE(renderer.has_value()) << renderer.error().message();
  render::PanoramaView view;
  view.panorama = {360, 240, 2.0 * std::numbers::pi, 6.0, -6.0};
  view.quality.samples = 1;
  RadianceImage image;
  for (const Eigen::Vector3d& eye : {Eigen::Vector3d(0.0, 1.6, 3.1),
                                     {-8.3, 1.6, 3.0},
                                     {8.3, 1.6, 0.2},
                                     {0.0, 5.5, 0.0},
                                     {0.0, 1.6, 5.5},
                                     {-5.9, 3.4, -2.4},
                                     {6.2, 2.2, -1.2}}) {
    view.eye = eye;
    (*renderer)->render_radiance(view, {0, 0, 360, 240}, &image, nullptr);
    const float brightest = *std::max_element(image.data().begin(), image.data().end());
    EXPECT_LT(brightest, 1.0f) << eye.transpose();
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, ClosedGrotto, testing::Values(10'000u, 37'000u, 250'000u));

}  // namespace
}  // namespace cyclorama::generator
