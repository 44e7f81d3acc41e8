// SPDX-License-Identifier: Apache-2.0
// The step from the last moving picture with stored light to the pictures at rest, with the real ray tracer.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "common/base/file.h"
#include "renderfarm/node/block_work.h"
#include "renderfarm/node/embree_block_renderer.h"
#include "renderfarm/node/light_program.h"
#include "renderfarm/quality/flip.h"

namespace cyclorama::node {
namespace {

namespace fs = std::filesystem;

constexpr int kReference = 16;

class PictureAtRest : public testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(folder);
    fs::create_directories(folder);
    std::ofstream(scene) << "v -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nv -2 1 -2\nv 2 1 -2\nf 1 3 2\nf 1 4 3\nf 1 2 6\n"
                            "f 1 6 5\n";
    const fs::path file = folder / "light.store";
    ASSERT_TRUE(compute_light(scene, file, 1, [](double) {}));
    renderer = *embree_scene_loader(std::make_shared<render::Crew>(1))(scene.string(), [](double) {});
    const auto mapped = MappedFile::open(file);
    ASSERT_TRUE(mapped);
    const auto light = renderer->add_light(mapped->bytes(), file.string());
    ASSERT_TRUE(light) << light.error().message();
    view.set_number(1);
    view.set_bounces(1);
    view.set_jpeg_quality(95);
    view.mutable_eye_m()->set_y(0.5);
    view.mutable_eye_m()->set_z(1.5);
    view.mutable_panorama()->set_width_px(128);
    view.mutable_panorama()->set_height_px(64);
    view.mutable_panorama()->set_azimuth_span_rad(1.5);
    view.mutable_panorama()->set_tan_elevation_top(0.3);
    view.mutable_panorama()->set_tan_elevation_bottom(-0.6);
    version = light->version;
  }
  ~PictureAtRest() override { fs::remove_all(folder); }

  RgbImage rendered(const wire::View& of, bool at_rest) {
    auto order = std::make_shared<BlockOrder>();
    order->renderer = renderer;
    order->block.set_width_px(128);
    order->block.set_height_px(64);
    order->block.set_keep(at_rest);
    *order->block.mutable_view() = of;
    auto work = BlockWork::begin(order);
    EXPECT_TRUE(work) << work.error().message();
    return std::move(work->next_tiles(films, crew, {[] { return false; }, [] { return false; }}).at(0).pixels);
  }
  /// Returns the picture at rest of so many samples.
  RgbImage at_rest(std::uint32_t samples, bool with_prior) {
    wire::View resting = view;
    resting.set_samples(samples);
    resting.set_sequence(kReference);
    if (with_prior) {
      resting.set_light(version);
      resting.set_prior_samples(4);
      resting.set_prior_weight(40.0f);
    }
    return rendered(resting, true);
  }

  const fs::path folder = fs::path(testing::TempDir()) / "picture_at_rest_test";
  const fs::path scene = folder / "sheet.obj";
  std::shared_ptr<BlockRenderer> renderer;
  std::string version;
  wire::View view;
  FilmStore films;
  render::Crew crew{1};
};

TEST_F(PictureAtRest, begins_as_the_moving_picture_with_stored_light_ended) {
  wire::View moving = view;
  moving.set_samples(4);
  moving.set_stored_light(true);
  moving.set_light(version);
  const RgbImage last = rendered(moving, false);
  const double step = quality::flip(at_rest(1, true), last)->mean;
  const double step_to_paths = quality::flip(at_rest(1, false), last)->mean;
  EXPECT_LE(step, 0.02);
  EXPECT_GT(step_to_paths, 2.0 * step) << "what it would be without";
  EXPECT_LE(quality::flip(at_rest(2, true), at_rest(1, true))->mean, 0.02) << "the next step";
}

TEST_F(PictureAtRest, ends_as_the_reference_of_paths_alone_bit_by_bit) {
  EXPECT_EQ(at_rest(kReference, true), at_rest(kReference, false));
}

}  // namespace
}  // namespace cyclorama::node
