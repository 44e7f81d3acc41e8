// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/drm/drm_output.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>

#include "drivers/output/drm/mode_choice.h"
#include "drivers/output/gl_objects.h"
#include "tests/doubles/fake_card/fake_machine.h"

namespace cyclorama::output {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class DrmOutputTest : public ::testing::Test {
 protected:
  DrmOptions three_heads() const {
    DrmOptions options;
    options.heads = {{{"left", 64, 36}, "HDMI-A-1"}, {{"middle", 64, 36}, "HDMI-A-2"}, {{"right", 64, 36}, "HDMI-A-3"}};
    options.flip_timeout = std::chrono::milliseconds(20);
    options.make_probe_runner = [this] { return machine_->probe_runner(); };
    return options;
  }
  void use(std::vector<FakeCard> cards) { machine_ = std::make_unique<FakeMachine>(std::move(cards), &clock_); }
  void open(const DrmOptions& options) {
    auto output = open_drm_output(options, clock_);
    ASSERT_TRUE(output) << output.error().message();
    output_ = *std::move(output);
  }
  /// Performs one refresh in which every head gets its own shade of `colour`.
  Status refresh(int colour) {
    TRY(output_->wait_for_refresh());
    for (std::size_t head = 0; head < output_->heads().size(); ++head) {
      TRY(output_->draw_to(head));
      fill(colour, static_cast<int>(head));
    }
    TRY_ASSIGN(presented_, output_->present());
    return Done{};
  }
  void fill(int colour, int head) const {
    const Gl& gl = output_->gl();
    gl.ClearColor(static_cast<float>(colour) / 255.0f, static_cast<float>(head) / 255.0f, 0.0f, 1.0f);
    gl.Clear(GL_COLOR_BUFFER_BIT);
  }
  /// Returns the centre pixel of a connector's picture: {colour, head, 0}, or {-1} if it is dark.
  std::vector<int> seen(std::size_t connector, std::size_t card = 0) const {
    const auto wall = machine_->wall(card, connector);
    if (!wall) return {-1};
    const std::uint8_t* const p = wall->at(wall->width() / 2, wall->height() / 2);
    return {p[0], p[1], p[2]};
  }

  FakeClock clock_;
  std::unique_ptr<FakeMachine> machine_;
  std::unique_ptr<Output> output_;
  Presented presented_;
};

TEST_F(DrmOutputTest, shows_each_head_on_its_connector_with_one_commit) {
  use({three_projectors()});
  open(three_heads());
  EXPECT_EQ(output_->heads().size(), 3U);
  EXPECT_NEAR(output_->refresh_hz(), 60.0, 0.5);
  EXPECT_THAT(output_->kind(), HasSubstr("left: HDMI-A-1 CYC P1, 64x36@"));
  const int before = machine_->commits(0);
  for (int colour = 1; colour <= 5; ++colour) {
    ASSERT_TRUE(refresh(colour));
    for (std::size_t head = 0; head < 3; ++head)
      EXPECT_THAT(seen(head), ElementsAre(colour, static_cast<int>(head), 0));
  }
  EXPECT_EQ(machine_->commits(0), before + 5);
  EXPECT_EQ(machine_->modesets(0), 1);
}

TEST_F(DrmOutputTest, counts_refreshes_at_the_projectors_pace) {
  use({three_projectors()});
  open(three_heads());
  ASSERT_TRUE(refresh(1));
  const Presented first = presented_;
  for (int n = 0; n < 10; ++n) ASSERT_TRUE(refresh(n));
  EXPECT_EQ(presented_.refresh, first.refresh + 10);
  EXPECT_NEAR(to_seconds(presented_.at - first.at), 10.0 / 60.0, 1e-3);
}

TEST_F(DrmOutputTest, commits_nothing_if_nothing_is_new) {
  use({three_projectors()});
  open(three_heads());
  ASSERT_TRUE(refresh(7));
  ASSERT_TRUE(output_->wait_for_refresh());
  const int before = machine_->commits(0);
  ASSERT_TRUE(output_->present());
  EXPECT_EQ(machine_->commits(0), before);
}

TEST_F(DrmOutputTest, keeps_a_pace_of_one_second_while_it_sleeps) {
  use({three_projectors()});
  std::atomic<bool> is_awake{false};
  DrmOptions options = three_heads();
  options.is_awake = &is_awake;
  open(options);
  const TimePoint before = clock_.now();
  for (int n = 0; n < 60; ++n) ASSERT_TRUE(refresh(n));
  EXPECT_NEAR(to_seconds(clock_.now() - before), 1.0, 0.05);
}

/// Uses a picture with distinct corners in every rotation; rows of the result count from the top.
TEST_F(DrmOutputTest, rotates_a_heads_picture) {
  const auto corners = [&](Rotation rotation) {
    output_.reset();
    FakeCard card = three_projectors();
    card.connectors.resize(1);
    machine_.reset();
    use({card});
    DrmOptions options = three_heads();
    options.heads.resize(1);
    options.heads[0].rotation = rotation;
    const bool is_aside = rotation == Rotation::kQuarter || rotation == Rotation::kThreeQuarters;
    options.heads[0].mode = {"left", is_aside ? 36 : 64, is_aside ? 64 : 36};
    open(options);
    EXPECT_TRUE(output_->draw_to(0));
    const Gl& gl = output_->gl();
    auto program = GlProgram::link(gl,
                                   "#version 300 es\nvoid main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, "
                                   "gl_VertexID == 2 ? 3.0 : -1.0, 0, 1); }",
                                   "#version 300 es\nprecision highp float;\nout vec4 c;\nvoid main() { c = "
                                   "vec4(floor(gl_FragCoord.xy) / 255.0, 0, 1); }");
    EXPECT_TRUE(program);
    gl.UseProgram(program->id());
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
    EXPECT_TRUE(output_->present());
    const auto wall = machine_->wall(0, 0);
    EXPECT_TRUE(wall);
    std::vector<std::pair<int, int>> colours;
    for (const auto& [x, y] : {std::pair(0, 0), std::pair(63, 0), std::pair(63, 35), std::pair(0, 35)})
      colours.emplace_back(wall->at(x, y)[0], wall->at(x, y)[1]);
    return colours;
  };
  using P = std::pair<int, int>;
  // The picture's own corners, (x from the left, y from the bottom), clockwise from the panel's top left.
  EXPECT_THAT(corners(Rotation::kNone), ElementsAre(P(0, 35), P(63, 35), P(63, 0), P(0, 0)));
  EXPECT_THAT(corners(Rotation::kQuarter), ElementsAre(P(0, 0), P(0, 63), P(35, 63), P(35, 0)));
  EXPECT_THAT(corners(Rotation::kHalf), ElementsAre(P(63, 0), P(0, 0), P(0, 35), P(63, 35)));
  EXPECT_THAT(corners(Rotation::kThreeQuarters), ElementsAre(P(35, 63), P(35, 0), P(0, 0), P(0, 63)));
}

TEST_F(DrmOutputTest, shows_every_8_bit_value_unchanged_with_10_bits) {
  FakeCard card = three_projectors();
  for (FakeConnector& connector : card.connectors) {
    connector.edid = fake_edid("deep", 10);
    connector.max_bpc = 12;
  }
  use({card});
  open(three_heads());
  EXPECT_TRUE(machine_->is_deep(0, 2));
  EXPECT_THAT(output_->kind(), HasSubstr("10 bit"));
  for (int colour = 0; colour < 256; ++colour) {
    ASSERT_TRUE(refresh(colour));
    ASSERT_THAT(seen(1), ElementsAre(colour, 1, 0));
  }
}

TEST_F(DrmOutputTest, is_no_deeper_than_cable_projector_and_card_allow) {
  FakeCard card = three_projectors();
  card.connectors[0].edid = fake_edid("shallow", 8);
  card.connectors[0].max_bpc = 12;
  card.connectors[1].edid = fake_edid("deep", 12);
  card.connectors[2].edid = fake_edid("deep", 12);
  card.connectors[2].max_bpc = 12;
  use({card});
  open(three_heads());
  EXPECT_FALSE(machine_->is_deep(0, 0));
  EXPECT_FALSE(machine_->is_deep(0, 1));
  EXPECT_TRUE(machine_->is_deep(0, 2));
  output_.reset();
  machine_.reset();
  card.can_be_deep = false;
  use({card});
  open(three_heads());
  EXPECT_FALSE(machine_->is_deep(0, 2));
  ASSERT_TRUE(refresh(5));
  EXPECT_THAT(seen(2), ElementsAre(5, 2, 0));
}

TEST_F(DrmOutputTest, flips_the_heads_of_two_cards_and_draws_on_the_first) {
  FakeCard second = three_projectors();
  second.path = "/dev/dri/card1";
  use({three_projectors(), second});
  DrmOptions options = three_heads();
  options.heads.push_back({{"ceiling", 64, 36}, "1:HDMI-A-2"});
  open(options);
  ASSERT_TRUE(refresh(9));
  EXPECT_THAT(seen(2, 0), ElementsAre(9, 2, 0));
  EXPECT_THAT(seen(1, 1), ElementsAre(9, 3, 0));
  EXPECT_THAT(seen(0, 1), ElementsAre(-1));
  output_.reset();
  EXPECT_EQ(machine_->held(), 0U);
}

TEST_F(DrmOutputTest, scales_to_the_mode_of_another_projector) {
  FakeCard card = three_projectors();
  card.connectors[1].modes = {fake_mode(32, 18, 60.0, true)};
  card.connectors[2].modes.clear();
  card.connectors[2].edid.clear();
  use({card});
  open(three_heads());
  ASSERT_TRUE(refresh(3));
  EXPECT_EQ(machine_->wall(0, 1)->width(), 32);
  EXPECT_THAT(seen(1), ElementsAre(3, 1, 0));
  EXPECT_EQ(machine_->wall(0, 2)->width(), 1024);
  EXPECT_THAT(seen(2), ElementsAre(3, 2, 0));
}

TEST_F(DrmOutputTest, uses_smaller_modes_if_the_card_lacks_bandwidth) {
  FakeCard card = three_projectors();
  for (FakeConnector& connector : card.connectors) connector.modes.push_back(fake_mode(16, 9, 60.0));
  const std::uint64_t full = fake_mode(64, 36, 60.0).clock;
  card.max_clock_khz = 2 * full + fake_mode(16, 9, 60.0).clock;
  use({card});
  open(three_heads());
  ASSERT_TRUE(refresh(3));
  EXPECT_EQ(machine_->wall(0, 0)->width(), 64);
  EXPECT_EQ(machine_->wall(0, 1)->width(), 64);
  EXPECT_EQ(machine_->wall(0, 2)->width(), 16);
  EXPECT_THAT(seen(2), ElementsAre(3, 2, 0));
}

TEST_F(DrmOutputTest, shows_the_last_picture_on_a_projector_that_comes_back) {
  use({three_projectors()});
  open(three_heads());
  ASSERT_TRUE(refresh(40));
  machine_->connector(0, 1).is_connected = false;
  machine_->hot_plug();
  ASSERT_TRUE(output_->wait_for_refresh());
  ASSERT_TRUE(output_->present());
  EXPECT_THAT(seen(1), ElementsAre(-1));
  EXPECT_THAT(seen(2), ElementsAre(40, 2, 0));
  EXPECT_THAT(output_->kind(), HasSubstr("middle: HDMI-A-2 is dark"));
  // Another connector takes its place.
  machine_->connector(0, 1).is_connected = true;
  machine_->connector(0, 1).modes = {fake_mode(80, 45, 60.0, true)};
  machine_->connector(0, 1).edid = fake_edid("other", 8);
  machine_->hot_plug();
  ASSERT_TRUE(output_->wait_for_refresh());
  EXPECT_THAT(seen(1), ElementsAre(40, 1, 0));
  EXPECT_EQ(machine_->wall(0, 1)->width(), 80);
  ASSERT_TRUE(refresh(41));
  EXPECT_THAT(seen(1), ElementsAre(41, 1, 0));
}

TEST_F(DrmOutputTest, does_not_touch_the_screens_when_an_event_changes_nothing) {
  use({three_projectors()});
  open(three_heads());
  ASSERT_TRUE(refresh(1));
  const int before = machine_->modesets(0);
  machine_->hot_plug();
  ASSERT_TRUE(refresh(2));
  EXPECT_EQ(machine_->modesets(0), before);
}

TEST_F(DrmOutputTest, starts_without_projectors_and_uses_them_when_they_appear) {
  FakeCard card = three_projectors();
  for (FakeConnector& connector : card.connectors) connector.is_connected = false;
  use({card});
  open(three_heads());
  const TimePoint before = clock_.now();
  for (int n = 0; n < 60; ++n) ASSERT_TRUE(refresh(n));
  EXPECT_NEAR(to_seconds(clock_.now() - before), 1.0, 0.05);
  EXPECT_THAT(seen(0), ElementsAre(-1));
  machine_->connector(0, 0).is_connected = true;
  machine_->hot_plug();
  ASSERT_TRUE(refresh(99));
  EXPECT_THAT(seen(0), ElementsAre(99, 0, 0));
}

TEST_F(DrmOutputTest, follows_projectors_with_serials_to_other_connectors) {
  FakeCard card = three_projectors();
  for (std::size_t i = 0; i < 3; ++i) card.connectors[i].edid = fake_edid("P", 8, "S" + std::to_string(i));
  use({card});
  DrmOptions options = three_heads();
  for (std::size_t i = 0; i < 3; ++i) {
    options.heads[i].connector.clear();
    options.heads[i].serial = "S" + std::to_string(2 - i);
  }
  open(options);
  ASSERT_TRUE(refresh(9));
  EXPECT_THAT(seen(0), ElementsAre(9, 2, 0));
  EXPECT_THAT(seen(2), ElementsAre(9, 0, 0));
  std::swap(machine_->connector(0, 0).edid, machine_->connector(0, 1).edid);
  machine_->hot_plug();
  // Nothing is drawn again, as in a show that stands still.
  for (int n = 0; n < 3; ++n) {
    ASSERT_TRUE(output_->wait_for_refresh());
    ASSERT_TRUE(output_->present());
  }
  EXPECT_THAT(seen(0), ElementsAre(9, 1, 0));
  EXPECT_THAT(seen(1), ElementsAre(9, 2, 0));
}

TEST_F(DrmOutputTest, drives_a_connector_without_hot_plug_with_the_given_edid) {
  FakeCard card = three_projectors();
  card.connectors[1].has_hot_plug = false;
  const VideoTiming timing{2500, {64, 8, 8, 24, true}, {36, 2, 4, 358, true}};
  Edid edid;
  edid.maker = "EXT";
  edid.model = "Extender";
  edid.timings = {timing};
  card.connectors[1].modes = modes_of(edid.timings);
  use({card});
  DrmOptions options = three_heads();
  options.heads[1].edid = edid;
  open(options);
  ASSERT_TRUE(refresh(1));
  EXPECT_THAT(seen(1), ElementsAre(-1));
  output_.reset();
  options.heads[1].is_always_connected = true;
  open(options);
  ASSERT_TRUE(refresh(2));
  EXPECT_THAT(seen(1), ElementsAre(2, 1, 0));
  EXPECT_THAT(output_->kind(), HasSubstr("HDMI-A-2 EXT Extender, 64x36"));
  // Readings that find nothing connected change nothing.
  const int before = machine_->modesets(0);
  machine_->hot_plug();
  for (int n = 0; n < 60 * 6; ++n) ASSERT_TRUE(refresh(n % 256));
  EXPECT_EQ(machine_->modesets(0), before);
}

TEST_F(DrmOutputTest, states_what_is_wrong_with_an_edid) {
  FakeCard card = three_projectors();
  card.connectors[0].edid.clear();
  card.connectors[1].edid[127] ^= 1;
  use({card});
  open(three_heads());
  EXPECT_THAT(output_->kind(), HasSubstr("left: HDMI-A-1 (no EDID: check the cable"));
  EXPECT_THAT(output_->kind(), HasSubstr("middle: HDMI-A-2 (the EDID's bytes add up to 0x"));
}

TEST_F(DrmOutputTest, probes_only_the_dark_connectors_again) {
  FakeCard card = three_projectors();
  card.connectors[1].is_connected = false;
  use({card});
  open(three_heads());
  const int before = machine_->calls().at("drmModeGetConnector");
  for (int n = 0; n < 60 * 11; ++n) ASSERT_TRUE(refresh(n % 256));
  EXPECT_EQ(machine_->calls().at("drmModeGetConnector"), before + 2);
  EXPECT_EQ(machine_->calls().at("drmModeGetConnectorCurrent"), 4);
}

TEST_F(DrmOutputTest, sets_modes_only_on_the_connectors_that_change) {
  FakeCard card = three_projectors();
  card.connectors[1].is_connected = false;
  card.connectors[1].modeset_time = std::chrono::seconds(3);
  use({card});
  open(three_heads());
  machine_->connector(0, 1).is_connected = true;
  machine_->hot_plug();
  ASSERT_TRUE(refresh(1));
  const int before = machine_->modesets(0);
  const TimePoint begun_at = clock_.now();
  for (int n = 0; n < 60; ++n) ASSERT_TRUE(refresh(n));
  EXPECT_NEAR(to_seconds(clock_.now() - begun_at), 1.0, 0.01);
  EXPECT_EQ(output_->shown()[0].light, HeadShown::Light::kNew);
  EXPECT_EQ(output_->shown()[1].light, HeadShown::Light::kDark);
  for (int n = 0; n < 180; ++n) ASSERT_TRUE(refresh(n));
  EXPECT_EQ(output_->shown()[1].light, HeadShown::Light::kNew);
  EXPECT_THAT(seen(1), ElementsAre(179, 1, 0));
  EXPECT_EQ(machine_->modesets(0), before);
}

TEST_F(DrmOutputTest, gives_up_a_modeset_that_never_ends_and_sets_everything_anew) {
  FakeCard card = three_projectors();
  card.connectors[1].is_connected = false;
  use({card});
  open(three_heads());
  machine_->connector(0, 1).is_connected = true;
  machine_->connector(0, 1).modeset_time = std::chrono::hours(1);
  machine_->hot_plug();
  for (int n = 0; n < 60; ++n) ASSERT_TRUE(refresh(n));
  machine_->connector(0, 1).modeset_time = {};
  machine_->forget_commits(0);
  for (int n = 0; n < 60 * 10; ++n) ASSERT_TRUE(refresh(n % 256));
  for (std::size_t head = 0; head < 3; ++head) EXPECT_EQ(output_->shown()[head].light, HeadShown::Light::kNew) << head;
}

TEST_F(DrmOutputTest, shows_each_head_at_its_own_rate) {
  FakeCard card = three_projectors();
  card.connectors[1].modes = {fake_mode(64, 36, 24.0, true)};
  use({card});
  DrmOptions options = three_heads();
  options.flip_timeout = std::chrono::milliseconds(500);
  open(options);
  EXPECT_NEAR(output_->refresh_hz(), 60.0, 0.01);
  std::vector<int> pictures(3);
  for (int n = 0; n < 120; ++n) {
    ASSERT_TRUE(refresh(n));
    for (std::size_t head = 0; head < 3; ++head) {
      if (output_->shown()[head].light == HeadShown::Light::kNew) ++pictures[head];
    }
  }
  EXPECT_THAT(pictures, ElementsAre(120, ::testing::AllOf(::testing::Ge(47), ::testing::Le(48)), 120));
}

TEST_F(DrmOutputTest, lets_the_card_wait_for_the_gpu) {
  FakeCard card = three_projectors();
  card.has_fences = true;
  use({card});
  open(three_heads());
  machine_->set_render_time(std::chrono::milliseconds(9));
  ASSERT_TRUE(refresh(1));
  const int before = machine_->calls().at("glFinish");
  const Presented first = presented_;
  for (int n = 0; n < 200; ++n) ASSERT_TRUE(refresh(n));
  EXPECT_EQ(machine_->calls().at("glFinish"), before);
  // The first pictures may be begun too late, before it is known how long the GPU takes.
  EXPECT_LE(presented_.refresh, first.refresh + 202);
  EXPECT_THAT(seen(2), ElementsAre(199, 2, 0));
}

TEST_F(DrmOutputTest, waits_for_the_gpu_itself_if_a_fence_fails) {
  FakeCard card = three_projectors();
  card.has_fences = true;
  for (const char* const call : {"eglCreateSync", "eglDupNativeFenceFDANDROID", "ioctl"}) {
    output_.reset();
    machine_.reset();
    use({card});
    open(three_heads());
    const int before = machine_->calls().at("glFinish");
    machine_->fail(call, EIO);
    for (int n = 0; n < 3; ++n) ASSERT_TRUE(refresh(n));
    EXPECT_GT(machine_->calls().at("glFinish"), before) << call;
    EXPECT_THAT(seen(2), ElementsAre(2, 2, 0)) << call;
  }
}

TEST_F(DrmOutputTest, polls_if_there_are_no_hot_plug_events) {
  FakeCard card = three_projectors();
  card.connectors[0].is_connected = false;
  use({card});
  machine_->fail("udev_monitor_new_from_netlink", EPERM);
  open(three_heads());
  machine_->connector(0, 0).is_connected = true;
  for (int n = 0; n < 60 * 6; ++n) ASSERT_TRUE(refresh(50));
  EXPECT_THAT(seen(0), ElementsAre(50, 0, 0));
}

TEST_F(DrmOutputTest, waits_until_another_program_releases_the_card) {
  use({three_projectors()});
  open(three_heads());
  ASSERT_TRUE(refresh(1));
  machine_->set_master_taken(0, true);
  for (int n = 0; n < 200; ++n) ASSERT_TRUE(refresh(n));
  machine_->set_master_taken(0, false);
  for (int n = 0; n < 70; ++n) ASSERT_TRUE(refresh(77));
  for (std::size_t head = 0; head < 3; ++head) EXPECT_THAT(seen(head), ElementsAre(77, static_cast<int>(head), 0));
}

TEST_F(DrmOutputTest, is_lost_when_the_gpu_is_reset_and_a_new_one_shows_again) {
  use({three_projectors()});
  open(three_heads());
  ASSERT_TRUE(refresh(1));
  machine_->reset_gpu();
  const auto waited = output_->wait_for_refresh();
  ASSERT_FALSE(waited);
  EXPECT_EQ(waited.error().code(), ErrorCode::kUnavailable);
  output_.reset();
  EXPECT_EQ(machine_->held(), 0U);
  open(three_heads());
  ASSERT_TRUE(refresh(2));
  EXPECT_THAT(seen(1), ElementsAre(2, 1, 0));
}

TEST_F(DrmOutputTest, keeps_pace_on_a_card_without_vertical_blanks) {
  FakeCard card = three_projectors();
  card.has_raster = false;
  use({card});
  open(three_heads());
  ASSERT_TRUE(refresh(1));
  const Presented first = presented_;
  for (int n = 0; n < 60; ++n) ASSERT_TRUE(refresh(n));
  EXPECT_NEAR(to_seconds(presented_.at - first.at), 1.0, 0.05);
  EXPECT_EQ(presented_.refresh, first.refresh + 60);
}

TEST_F(DrmOutputTest, refuses_invalid_connectors_and_cards) {
  use({three_projectors()});
  const auto error_of = [&](auto change) {
    DrmOptions options = three_heads();
    change(&options);
    auto output = open_drm_output(options, clock_);
    EXPECT_FALSE(output);
    EXPECT_EQ(machine_->held(), 0U);
    return output.error();
  };
  EXPECT_EQ(error_of([](DrmOptions* o) { o->heads[0].connector = "x:y"; }).code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(error_of([](DrmOptions* o) { o->cards = {"/dev/dri/card7"}; }).code(), ErrorCode::kNotFound);
  machine_->set_master_taken(0, true);
  const Error busy = error_of([](DrmOptions*) {});
  EXPECT_EQ(busy.code(), ErrorCode::kBusy);
  EXPECT_THAT(busy.message(), HasSubstr("belongs to another display server"));
}

TEST_F(DrmOutputTest, leaks_nothing_whichever_call_fails) {
  use({three_projectors()});
  open(three_heads());
  output_.reset();
  const std::map<std::string, int> calls = machine_->calls();
  EXPECT_GT(calls.size(), 20U);
  for (const auto& [call, count] : calls) {
    for (int pass = 0; pass < std::min(count, 4); ++pass) {
      machine_->fail(call, EIO, pass);
      auto output = open_drm_output(three_heads(), clock_);
      if (output) {
        output->reset();
      } else {
        EXPECT_FALSE(output.error().message().empty());
      }
      EXPECT_EQ(machine_->held(), 0U) << call;
    }
  }
}

}  // namespace
}  // namespace cyclorama::output
