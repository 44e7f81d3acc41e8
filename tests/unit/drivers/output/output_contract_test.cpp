// SPDX-License-Identifier: Apache-2.0
// The contract of Output, tested for each kind: headless on EGL and on OSMesa, and DRM on the fake card.
#include "drivers/output/output.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <optional>

#include "drivers/output/drm/drm_output.h"
#include "drivers/output/gl_objects.h"
#include "drivers/output/headless/headless_output.h"
#include "drivers/output/shared_picture.h"
#include "tests/doubles/fake_card/fake_machine.h"

namespace cyclorama::output {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using Light = HeadShown::Light;

/// Opens an output of one kind and reads its pictures.
class Place {
 public:
  virtual ~Place() = default;
  virtual Result<std::unique_ptr<Output>> open(const std::vector<HeadMode>& heads, double refresh_hz) = 0;
  /// Returns rows from the top; nothing if the head is dark.
  virtual std::optional<RgbImage> seen(const HeadMode& head, std::size_t number) = 0;
  [[nodiscard]] virtual const Clock& clock() const = 0;
  /// A refresh rate that its heads support.
  [[nodiscard]] virtual double refresh_hz() const = 0;
  std::atomic<bool> is_awake{true};
};

class HeadlessPlace final : public Place {
 public:
  explicit HeadlessPlace(HeadlessOptions::Renderer renderer) : renderer_(renderer) {
    std::string folder = ::testing::TempDir() + "/contract.XXXXXX";
    CHECK(::mkdtemp(folder.data()) != nullptr);
    run_dir_ = folder;
  }
  ~HeadlessPlace() override { std::filesystem::remove_all(run_dir_); }
  Result<std::unique_ptr<Output>> open(const std::vector<HeadMode>& heads, double refresh_hz) override {
    return open_headless_output({heads, refresh_hz, run_dir_, renderer_, &is_awake}, clock_);
  }
  std::optional<RgbImage> seen(const HeadMode& head, std::size_t) override {
    auto reader = SharedPictureReader::open(shared_picture_path(run_dir_, head.name));
    CHECK(reader.has_value());
    RgbImage picture;
    CHECK(reader->read_newest(&picture).has_value());
    const bool is_black = std::ranges::all_of(picture.data(), [](std::uint8_t value) { return value == 0; });
    return is_black ? std::nullopt : std::optional(picture);
  }
  [[nodiscard]] const Clock& clock() const override { return clock_; }
  [[nodiscard]] double refresh_hz() const override { return 200.0; }

 private:
  HeadlessOptions::Renderer renderer_;
  SteadyClock clock_;
  std::filesystem::path run_dir_;
  FakeClock no_clock_;
  FakeMachine no_cards_{{}, &no_clock_};  // EGL's calls are wrapped in this program.
};

class DrmPlace final : public Place {
 public:
  Result<std::unique_ptr<Output>> open(const std::vector<HeadMode>& heads, double refresh_hz) override {
    DrmOptions options;
    for (std::size_t i = 0; i < heads.size(); ++i) options.heads.push_back({heads[i], fmt_connector(i)});
    options.refresh_hz = refresh_hz;
    options.flip_timeout = std::chrono::milliseconds(20);
    options.is_awake = &is_awake;
    options.make_probe_runner = [this] { return machine_.probe_runner(); };
    return open_drm_output(options, clock_);
  }
  std::optional<RgbImage> seen(const HeadMode&, std::size_t number) override { return machine_.wall(0, number); }
  [[nodiscard]] const Clock& clock() const override { return clock_; }
  [[nodiscard]] double refresh_hz() const override { return 60.0; }

 private:
  static std::string fmt_connector(std::size_t head) { return "HDMI-A-" + std::to_string(head + 1); }
  static FakeCard card() {
    FakeCard card = three_projectors();
    card.connectors[0].modes = {fake_mode(64, 48, 60.0, true)};
    card.connectors[1].modes = {fake_mode(31, 17, 60.0, true)};
    return card;
  }
  FakeClock clock_;
  FakeMachine machine_{{card()}, &clock_};
};

struct Kind {
  const char* name;
  std::function<std::unique_ptr<Place>()> make;
};

class OutputContract : public ::testing::TestWithParam<Kind> {
 protected:
  void SetUp() override { place_ = GetParam().make(); }
  void TearDown() override { output_.reset(); }

  void open() {
    auto opened = place_->open(kHeads, place_->refresh_hz());
    ASSERT_TRUE(opened) << opened.error().message();
    output_ = *std::move(opened);
  }
  const Gl& gl() const { return output_->gl(); }
  void fill(std::size_t head, std::array<int, 3> colour) {
    ASSERT_TRUE(output_->draw_to(head));
    const auto part = [&](std::size_t c) { return static_cast<float>(colour[c]) / 255.0f; };
    gl().ClearColor(part(0), part(1), part(2), 1.0f);
    gl().Clear(GL_COLOR_BUFFER_BIT);
  }
  Presented present() {
    EXPECT_TRUE(output_->wait_for_refresh());
    const auto presented = output_->present();
    EXPECT_TRUE(presented) << presented.error().message();
    return presented ? *presented : Presented{};
  }
  /// Red, green and blue of all pixels if they are equal; {-1} if the head is dark.
  std::vector<int> seen(std::size_t head) {
    const auto picture = place_->seen(kHeads[head], head);
    if (!picture) return {-1};
    EXPECT_EQ(picture->width(), kHeads[head].width_px);
    EXPECT_EQ(picture->height(), kHeads[head].height_px);
    const std::uint8_t* const first = picture->at(0, 0);
    for (std::size_t i = 0; i < picture->data().size(); ++i) EXPECT_EQ(picture->data()[i], first[i % 3]);
    return {first[0], first[1], first[2]};
  }
  std::vector<Light> lights() const {
    std::vector<Light> all;
    for (const HeadShown& head : output_->shown()) all.push_back(head.light);
    return all;
  }

  inline static const std::vector<HeadMode> kHeads{{"left", 64, 48}, {"a/b", 31, 17}};
  std::unique_ptr<Place> place_;
  std::unique_ptr<Output> output_;
};

TEST_P(OutputContract, shows_each_picture_on_the_head_for_which_it_was_drawn) {
  open();
  ASSERT_EQ(output_->heads().size(), 2U);
  EXPECT_EQ(output_->heads()[1].name, "a/b");
  EXPECT_NEAR(output_->refresh_hz(), place_->refresh_hz(), 0.5);
  fill(0, {255, 0, 100});
  fill(1, {0, 1, 100});
  const TimePoint before = place_->clock().now();
  const Presented presented = present();
  EXPECT_GE(presented.at, before);
  EXPECT_LE(presented.at, place_->clock().now());
  EXPECT_THAT(seen(0), ElementsAre(255, 0, 100));
  EXPECT_THAT(seen(1), ElementsAre(0, 1, 100));
}

TEST_P(OutputContract, keeps_the_picture_of_a_head_that_was_not_drawn) {
  open();
  fill(0, {0, 255, 0});
  fill(1, {7, 7, 7});
  present();
  for (int n = 1; n < 4; ++n) {
    fill(1, {n, n, n});
    present();
    EXPECT_THAT(seen(0), ElementsAre(0, 255, 0));
    EXPECT_THAT(seen(1), ElementsAre(n, n, n));
  }
  present();
  EXPECT_THAT(seen(0), ElementsAre(0, 255, 0));
  EXPECT_THAT(seen(1), ElementsAre(3, 3, 3));
}

TEST_P(OutputContract, counts_rows_from_the_bottom_as_gl_does) {
  open();
  auto program = GlProgram::link(
      gl(), "#version 300 es\nlayout(location = 0) in vec2 p;\nvoid main() { gl_Position = vec4(p, 0, 1); }",
      "#version 300 es\nprecision highp float;\nout vec4 c;\n"
      "void main() { c = vec4(floor(gl_FragCoord.xy) / 255.0, 0.0, 1.0); }");
  ASSERT_TRUE(program) << program.error().message();
  const GlVertexArray vertex_array(gl());
  const GlBuffer corners(gl());
  const GlBuffer indices(gl());
  const std::array<float, 6> triangle{-1, -1, 3, -1, -1, 3};
  const std::array<std::uint32_t, 3> order{0, 1, 2};
  gl().BindVertexArray(vertex_array.id());
  gl().BindBuffer(GL_ARRAY_BUFFER, corners.id());
  gl().BufferData(GL_ARRAY_BUFFER, sizeof triangle, triangle.data(), GL_STATIC_DRAW);
  gl().BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices.id());
  gl().BufferData(GL_ELEMENT_ARRAY_BUFFER, sizeof order, order.data(), GL_STATIC_DRAW);
  gl().VertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, 0, nullptr);
  gl().EnableVertexAttribArray(0);
  gl().UseProgram(program->id());
  ASSERT_TRUE(output_->draw_to(0));
  gl().DrawElements(GL_TRIANGLES, 3, GL_UNSIGNED_INT, nullptr);
  present();
  const auto picture = place_->seen(kHeads[0], 0);
  ASSERT_TRUE(picture);
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      ASSERT_EQ(picture->at(x, y)[0], x);
      ASSERT_EQ(picture->at(x, y)[1], 47 - y);
    }
  }
}

TEST_P(OutputContract, numbers_refreshes_upwards_whether_or_not_something_is_drawn) {
  open();
  std::optional<Presented> previous;
  for (int n = 0; n < 10; ++n) {
    if (n % 3 != 0) fill(0, {n, n, n});
    const Presented presented = present();
    if (previous) {
      EXPECT_GT(presented.refresh, previous->refresh);
      EXPECT_GT(presented.at, previous->at);
    }
    previous = presented;
  }
}

TEST_P(OutputContract, reports_what_each_head_did) {
  open();
  EXPECT_THAT(lights(), ElementsAre(Light::kDark, Light::kDark));
  fill(0, {1, 2, 3});
  fill(1, {4, 5, 6});
  present();
  const TimePoint before = place_->clock().now();
  fill(0, {2, 2, 3});
  fill(1, {4, 5, 7});
  const Presented presented = present();
  EXPECT_THAT(lights(), ElementsAre(Light::kNew, Light::kNew));
  for (const HeadShown& head : output_->shown()) {
    EXPECT_GE(head.at, before);
    EXPECT_LE(head.at, presented.at);
    EXPECT_NEAR(head.refresh_hz, place_->refresh_hz(), 0.5);
  }
  fill(1, {9, 9, 9});
  present();
  EXPECT_EQ(output_->shown()[1].light, Light::kNew);
  EXPECT_EQ(output_->shown()[0].light, Light::kSame);
  present();
  EXPECT_THAT(lights(), ElementsAre(Light::kSame, Light::kSame));
}

TEST_P(OutputContract, sleeps_and_shows_the_newest_pictures_when_it_wakes) {
  open();
  fill(0, {10, 0, 0});
  fill(1, {20, 0, 0});
  present();
  place_->is_awake = false;
  const Presented before = present();
  for (std::size_t head = 0; head < 2; ++head) EXPECT_THAT(seen(head), ElementsAre(-1));
  fill(0, {30, 0, 0});  // A frame that arrives while asleep.
  EXPECT_GT(present().refresh, before.refresh);
  EXPECT_THAT(lights(), ElementsAre(Light::kDark, Light::kDark));
  for (std::size_t head = 0; head < 2; ++head) EXPECT_THAT(seen(head), ElementsAre(-1));
  place_->is_awake = true;
  present();
  EXPECT_THAT(seen(0), ElementsAre(30, 0, 0));
  EXPECT_THAT(seen(1), ElementsAre(20, 0, 0));
  EXPECT_THAT(lights(), Each(::testing::Ne(Light::kDark)));
}

TEST_P(OutputContract, can_start_asleep) {
  place_->is_awake = false;
  open();
  fill(0, {10, 0, 0});
  fill(1, {20, 0, 0});
  present();
  for (std::size_t head = 0; head < 2; ++head) EXPECT_THAT(seen(head), ElementsAre(-1));
  place_->is_awake = true;
  present();
  EXPECT_THAT(seen(0), ElementsAre(10, 0, 0));
  EXPECT_THAT(seen(1), ElementsAre(20, 0, 0));
}

TEST_P(OutputContract, reports_the_errors_of_a_bad_shader) {
  open();
  const auto program = GlProgram::link(gl(), "#version 300 es\nnonsense", "#version 300 es\nvoid main() {}");
  ASSERT_FALSE(program);
  EXPECT_THAT(program.error().message(), ::testing::ContainsRegex("shader: .*error"));
  EXPECT_TRUE(gl().check("nothing"));
}

TEST_P(OutputContract, can_be_reopened) {
  for (int n = 1; n < 4; ++n) {
    output_.reset();
    open();
    EXPECT_FALSE(output_->kind().empty());
    EXPECT_FALSE(gl().renderer().empty());
    fill(1, {n, 0, 0});
    fill(0, {0, n, 0});
    present();
    EXPECT_THAT(seen(0), ElementsAre(0, n, 0));
    EXPECT_THAT(seen(1), ElementsAre(n, 0, 0));
  }
}

TEST_P(OutputContract, refuses_invalid_requests) {
  const auto code_of = [&](const std::vector<HeadMode>& heads, double refresh_hz) {
    const auto output = place_->open(heads, refresh_hz);
    EXPECT_FALSE(output);
    return output.error().code();
  };
  const double hz = place_->refresh_hz();
  EXPECT_EQ(code_of({}, hz), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code_of({{"a", 64, 48}, {"b", 0, 48}}, hz), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code_of({{"a", 64, 48}, {"b", 31, -1}}, hz), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code_of({{"a", 64, 48}, {"b", 31, 1 << 20}}, hz), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code_of(kHeads, 0.0), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code_of(kHeads, -60.0), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code_of(kHeads, std::nan("")), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code_of(kHeads, INFINITY), ErrorCode::kInvalidArgument);
}

using Renderer = HeadlessOptions::Renderer;
INSTANTIATE_TEST_SUITE_P(Kinds, OutputContract,
                         ::testing::Values(Kind{"egl", [] { return std::make_unique<HeadlessPlace>(Renderer::kEgl); }},
                                           Kind{"osmesa",
                                                [] { return std::make_unique<HeadlessPlace>(Renderer::kOsMesa); }},
                                           Kind{"drm", [] { return std::make_unique<DrmPlace>(); }}),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace cyclorama::output
