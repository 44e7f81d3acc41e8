// SPDX-License-Identifier: Apache-2.0
// Films of the real ray tracer, accumulated as on a node.
#include "renderfarm/node/embree_block_renderer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>

#include "renderfarm/render/renderer.h"
#include "renderfarm/render/tone.h"
#include "renderfarm/scene/scene.h"
#include "tests/data_sets/simple_scenes.h"

namespace cyclorama::node {
namespace {

constexpr int kReference = 256;
constexpr PixelRect kRect = {16, 0, 48, 32};

constexpr const char* kFoldedSheet =
    "v -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nv -2 1 -2\nv 2 1 -2\nf 1 3 2\nf 1 4 3\nf 1 2 6\nf 1 6 5\n";

/// A folded sheet lit by the importer's lights, with penumbrae and corners.
std::unique_ptr<BlockRenderer> folded_sheet() {
  const std::filesystem::path file = testing::TempDir() + "folded_sheet.obj";
  std::ofstream(file) << kFoldedSheet;
  auto loaded = embree_scene_loader(std::make_shared<render::Crew>(1))(file.string(), [](double) {});
  std::filesystem::remove(file);
  EXPECT_TRUE(loaded) << loaded.error().message();
  return *std::move(loaded);
}

render::PanoramaView view_of_sheet() {
  render::PanoramaView view = view_from({0.0, 0.5, 1.5}, 64, 32, 0.5, -0.8);
  view.quality.bounces = 1;
  view.quality.sequence = kReference;
  view.seed = 7;
  return view;
}

/// Accumulates samples in steps that end at the given counts; each step is cut by cut_samples().
render::Film accumulated(BlockRenderer& renderer, const render::PanoramaView& view, const PixelRect& rect,
                         std::vector<int> steps) {
  render::Film film(rect.width, rect.height, false);
  int have = 0;
  for (const int end : steps) {
    for (const governor::SampleRange& range : governor::cut_samples({have, end}, 64)) {
      render::Film part(rect.width, rect.height, false);
      renderer.render_film(view, rect, range, &part, nullptr);
      film.add(part);
    }
    have = end;
  }
  return film;
}

double squared_error(const RadianceImage& a, const RadianceImage& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.data().size(); ++i) {
    const double difference = static_cast<double>(a.data()[i]) - static_cast<double>(b.data()[i]);
    sum += difference * difference;
  }
  return sum / static_cast<double>(a.data().size());
}

TEST(EmbreeBlockRenderer, accumulates_bit_by_bit_what_it_renders_at_once_however_it_is_divided) {
  const auto renderer = folded_sheet();
  const render::PanoramaView view = view_of_sheet();
  const render::Film steps = accumulated(*renderer, view, kRect, {2, 8, 16, 64, 128});
  const render::Film afresh = accumulated(*renderer, view, kRect, {128});
  EXPECT_EQ(steps.sum, afresh.sum);
  EXPECT_EQ(renderer->developed(steps.mean()), renderer->developed(afresh.mean()));
  const render::Film part = accumulated(*renderer, view, {32, 16, 16, 16}, {128});
  for (int y = 0; y < 16; ++y) {
    for (int c = 0; c < 48; ++c) ASSERT_EQ(part.sum.at(0, y)[c], afresh.sum.at(16, 16 + y)[c]);
  }
}

TEST(EmbreeBlockRenderer, develops_a_film_to_the_codes_of_render_with_the_scenes_tone_curve) {
  for (const char* const curve : {"shoulder", "linear", "filmic"}) {
    const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "toned_scene";
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "sheet.obj") << kFoldedSheet;
    std::ofstream(folder / "scene.toml") << "title = \"Sheet\"\n[tone]\ncurve = \"" << curve
                                         << "\"\n[[geometry]]\nfile = \"sheet.obj\"\n";
    const auto loaded = embree_scene_loader(std::make_shared<render::Crew>(1))(folder.string(), [](double) {});
    auto scene = scene::load_scene(folder.string(), scene::ImportLimits{}, [](double) {});
    std::filesystem::remove_all(folder);
    ASSERT_TRUE(loaded && scene) << loaded.error().message();
    const auto direct = render::Renderer::build(*std::move(scene), 1, nullptr);
    ASSERT_TRUE(direct) << direct.error().message();
    render::PanoramaView view = view_of_sheet();
    view.quality.samples = 7;  // The division by 7 rounds.
    RgbImage picture;
    (*direct)->render(view, kRect, &picture, nullptr);
    render::Film film(kRect.width, kRect.height, false);
    (*loaded)->render_film(view, kRect, {0, 7}, &film, nullptr);
    EXPECT_EQ((*loaded)->developed(film.mean()), picture) << curve;
    const bool shoulder = cyclorama::render::developed(film.mean(), scene::ToneCurve::kShoulder) == picture;
    EXPECT_EQ(shoulder, curve == std::string("shoulder"));
  }
}

TEST(EmbreeBlockRenderer, accumulates_the_same_as_one_render_up_to_rounding) {
  const auto renderer = folded_sheet();
  const render::PanoramaView view = view_of_sheet();
  const RadianceImage pieces = accumulated(*renderer, view, kRect, {64}).mean();
  render::Film whole(kRect.width, kRect.height, false);
  renderer->render_film(view, kRect, {0, 64}, &whole, nullptr);
  const RadianceImage once = whole.mean();
  for (std::size_t i = 0; i < once.data().size(); ++i) {
    ASSERT_NEAR(pieces.data()[i], once.data()[i], 64 * 1.2e-7f * once.data()[i]) << i;
  }
}

TEST(EmbreeBlockRenderer, has_an_error_that_falls_at_least_by_the_square_root_law) {
  const auto renderer = folded_sheet();
  render::PanoramaView view = view_of_sheet();
  view.quality.sequence = 2048;
  view.seed = 12345;
  const RadianceImage reference = accumulated(*renderer, view, kRect, {2048}).mean();
  view.seed = 7;
  view.quality.sequence = kReference;
  double last = INFINITY;
  double first = 0.0;
  for (int samples = 4; samples <= kReference; samples *= 4) {
    const double error = squared_error(accumulated(*renderer, view, kRect, {samples}).mean(), reference);
    EXPECT_LT(error, last) << samples;
    if (samples == 4) first = error;
    last = error;
  }
  // Mean squared error falls at least with slope -1 from 4 to 256 samples, since the samples are stratified.
  const double slope = std::log(last / first) / std::log(kReference / 4.0);
  EXPECT_LT(slope, -0.9);
}

TEST(EmbreeBlockRenderer, denoises_the_same_picture_however_often_it_is_interrupted) {
  const auto renderer = folded_sheet();
  for (const int samples : {1, 70}) {  // At once, and in three pieces.
    render::PanoramaView view = view_of_sheet();
    view.quality.samples = samples;
    view.depth = true;
    RadianceImage at_once;
    InverseDepthImage depth;
    renderer->begin_denoised(view, kRect)->advance([] { return false; }, &at_once, &depth);
    ASSERT_FALSE(at_once.empty());
    ASSERT_FALSE(depth.empty());
    const auto work = renderer->begin_denoised(view, kRect);
    RadianceImage picture;
    InverseDepthImage interrupted_depth;
    int calls = 0;
    std::uint64_t rays = 0;
    while (picture.empty()) {
      ASSERT_LT(++calls, 100);
      int checks = 0;
      rays += work->advance([&] { return ++checks > 3; }, &picture, &interrupted_depth).rays;
    }
    EXPECT_GT(calls, 1);
    EXPECT_GT(rays, 0u);
    EXPECT_EQ(picture, at_once) << samples;
    EXPECT_EQ(interrupted_depth, depth) << samples;
  }
}

TEST(EmbreeBlockRenderer, reports_the_speed_of_this_host) {
  const auto renderer = folded_sheet();
  EXPECT_GT(renderer->probe_cpu_seconds(), 0.0);
  EXPECT_TRUE(std::isfinite(renderer->probe_cpu_seconds()));
}

}  // namespace
}  // namespace cyclorama::node
