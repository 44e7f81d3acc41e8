// SPDX-License-Identifier: Apache-2.0
// The contract of Output, kept by each renderer of the headless one.
#include "drivers/output/headless/headless_output.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "drivers/output/gl_objects.h"
#include "drivers/output/shared_picture.h"

namespace cyclorama {
namespace {

using Renderer = HeadlessOptions::Renderer;

class OutputContract : public ::testing::TestWithParam<Renderer> {
 protected:
  void SetUp() override {
    std::string folder = ::testing::TempDir() + "/headless.XXXXXX";
    ASSERT_NE(::mkdtemp(folder.data()), nullptr);
    run_dir_ = folder;
  }
  void TearDown() override { std::filesystem::remove_all(run_dir_); }

  HeadlessOptions options() const { return {{{"left", 64, 48}, {"a/b", 31, 17}}, 200.0, run_dir_, GetParam()}; }
  RgbImage shown(const std::string& head, SharedPictureInfo* ret_info = nullptr) {
    auto reader = SharedPictureReader::open(shared_picture_path(run_dir_, head));
    EXPECT_TRUE(reader);
    RgbImage picture;
    const auto info = reader->read_newest(&picture);
    EXPECT_TRUE(info) << info.error().message();
    if (ret_info != nullptr && info) *ret_info = *info;
    return picture;
  }
  SteadyClock clock_;
  std::filesystem::path run_dir_;
};

TEST_P(OutputContract, shows_what_was_drawn_on_the_head_that_it_was_drawn_to) {
  auto output = open_headless_output(options(), clock_);
  ASSERT_TRUE(output) << output.error().message();
  ASSERT_EQ((*output)->heads().size(), 2U);
  EXPECT_EQ((*output)->refresh_hz(), 200.0);
  const Gl& gl = (*output)->gl();
  ASSERT_TRUE((*output)->wait_for_refresh());
  for (std::size_t head = 0; head < 2; ++head) {
    ASSERT_TRUE((*output)->draw_to(head));
    gl.ClearColor(head == 0 ? 1.0f : 0.0f, 0.0f, 100.0f / 255.0f, 1.0f);
    gl.Clear(GL_COLOR_BUFFER_BIT);
  }
  const TimePoint before = clock_.now();
  const auto presented = (*output)->present();
  ASSERT_TRUE(presented) << presented.error().message();
  EXPECT_GE(presented->at, before);
  EXPECT_LE(presented->at, clock_.now());

  SharedPictureInfo info;
  const RgbImage left = shown("left", &info);
  ASSERT_EQ(left.width(), 64);
  ASSERT_EQ(left.height(), 48);
  EXPECT_EQ(info.refresh, presented->refresh);
  EXPECT_EQ(info.presented_at, presented->at);
  const RgbImage other = shown("a/b");
  ASSERT_EQ(other.width(), 31);
  for (std::size_t i = 0; i < left.data().size(); i += 3) {
    ASSERT_THAT(left.data().subspan(i, 3), ::testing::ElementsAre(255, 0, 100));
  }
  for (std::size_t i = 0; i < other.data().size(); i += 3) {
    ASSERT_THAT(other.data().subspan(i, 3), ::testing::ElementsAre(0, 0, 100));
  }
}

TEST_P(OutputContract, keeps_the_picture_of_a_head_that_was_not_drawn) {
  auto output = open_headless_output(options(), clock_);
  ASSERT_TRUE(output);
  ASSERT_TRUE((*output)->draw_to(0));
  (*output)->gl().ClearColor(0.0f, 1.0f, 0.0f, 1.0f);
  (*output)->gl().Clear(GL_COLOR_BUFFER_BIT);
  ASSERT_TRUE((*output)->present());
  ASSERT_TRUE((*output)->present());
  SharedPictureInfo info;
  EXPECT_THAT(shown("left", &info).data().subspan(0, 3), ::testing::ElementsAre(0, 255, 0));
  EXPECT_EQ(info.picture, 1U);
}

TEST_P(OutputContract, counts_rows_from_the_bottom_as_gl_does) {
  auto output = open_headless_output(options(), clock_);
  ASSERT_TRUE(output);
  const Gl& gl = (*output)->gl();
  auto program = GlProgram::link(
      gl, "#version 300 es\nlayout(location = 0) in vec2 p;\nvoid main() { gl_Position = vec4(p, 0, 1); }",
      "#version 300 es\nprecision highp float;\nout vec4 c;\n"
      "void main() { c = vec4(floor(gl_FragCoord.xy) / 255.0, 0.0, 1.0); }");
  ASSERT_TRUE(program) << program.error().message();
  const GlVertexArray vertex_array(gl);
  const GlBuffer corners(gl);
  const GlBuffer indices(gl);
  const std::array<float, 6> triangle{-1, -1, 3, -1, -1, 3};
  const std::array<std::uint32_t, 3> order{0, 1, 2};
  gl.BindVertexArray(vertex_array.id());
  gl.BindBuffer(GL_ARRAY_BUFFER, corners.id());
  gl.BufferData(GL_ARRAY_BUFFER, sizeof triangle, triangle.data(), GL_STATIC_DRAW);
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices.id());
  gl.BufferData(GL_ELEMENT_ARRAY_BUFFER, sizeof order, order.data(), GL_STATIC_DRAW);
  gl.VertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, 0, nullptr);
  gl.EnableVertexAttribArray(0);
  gl.UseProgram(program->id());
  ASSERT_TRUE((*output)->draw_to(0));
  gl.DrawElements(GL_TRIANGLES, 3, GL_UNSIGNED_INT, nullptr);
  ASSERT_TRUE((*output)->present());
  const RgbImage picture = shown("left");
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      ASSERT_EQ(picture.at(x, y)[0], x);
      ASSERT_EQ(picture.at(x, y)[1], 47 - y);
    }
  }
}

TEST_P(OutputContract, numbers_refreshes_upwards) {
  auto output = open_headless_output(options(), clock_);
  ASSERT_TRUE(output);
  std::optional<Presented> previous;
  for (int n = 0; n < 5; ++n) {
    ASSERT_TRUE((*output)->wait_for_refresh());
    const auto presented = (*output)->present();
    ASSERT_TRUE(presented);
    if (previous) {
      EXPECT_GT(presented->refresh, previous->refresh);
      EXPECT_GT(presented->at, previous->at);
    }
    previous = *presented;
  }
}

TEST_P(OutputContract, says_what_a_bad_shader_is_refused_for) {
  auto output = open_headless_output(options(), clock_);
  ASSERT_TRUE(output);
  const auto program = GlProgram::link((*output)->gl(), "#version 300 es\nnonsense", "#version 300 es\nvoid main() {}");
  ASSERT_FALSE(program);
  EXPECT_THAT(program.error().message(), ::testing::ContainsRegex("shader: .*error"));
  EXPECT_TRUE((*output)->gl().check("nothing"));
}

TEST_P(OutputContract, can_be_opened_again_and_needs_no_run_directory) {
  HeadlessOptions opened = options();
  opened.run_dir.clear();
  for (int n = 0; n < 3; ++n) {
    auto output = open_headless_output(opened, clock_);
    ASSERT_TRUE(output) << output.error().message();
    EXPECT_FALSE((*output)->kind().empty());
    EXPECT_FALSE((*output)->gl().renderer().empty());
    ASSERT_TRUE((*output)->draw_to(1));
    ASSERT_TRUE((*output)->present());
  }
}

TEST_P(OutputContract, refuses_what_cannot_be) {
  const auto code_of = [&](auto change) {
    HeadlessOptions opened = options();
    change(&opened);
    const auto output = open_headless_output(opened, clock_);
    EXPECT_FALSE(output);
    return output.error().code();
  };
  EXPECT_EQ(code_of([](HeadlessOptions* o) { o->heads.clear(); }), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code_of([](HeadlessOptions* o) { o->heads[1].width_px = 0; }), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code_of([](HeadlessOptions* o) { o->heads[1].height_px = 1 << 20; }), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code_of([](HeadlessOptions* o) { o->refresh_hz = 0.0; }), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code_of([](HeadlessOptions* o) { o->refresh_hz = std::nan(""); }), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code_of([](HeadlessOptions* o) { o->run_dir = "/nowhere/at/all"; }), ErrorCode::kNotFound);
}

INSTANTIATE_TEST_SUITE_P(Headless, OutputContract, ::testing::Values(Renderer::kEgl, Renderer::kOsMesa),
                         [](const auto& tested) { return tested.param == Renderer::kEgl ? "egl" : "osmesa"; });

}  // namespace
}  // namespace cyclorama
