// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/client/farm_client.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/image/jpeg.h"
#include "tests/doubles/fake_farm.h"
#include "tests/doubles/recording_farm_listener.h"

namespace cyclorama::client {
namespace {

using std::chrono::seconds;
using testing::HasSubstr;

wire::View view_of(std::uint64_t number, std::uint32_t width = 600, std::uint32_t height = 300) {
  wire::View view;
  view.set_number(number);
  view.set_samples(1);
  view.set_jpeg_quality(90);
  view.mutable_eye_m();
  view.mutable_panorama()->set_width_px(width);
  view.mutable_panorama()->set_height_px(height);
  view.mutable_panorama()->set_azimuth_span_rad(2.0);
  view.mutable_panorama()->set_tan_elevation_top(0.5);
  view.mutable_panorama()->set_tan_elevation_bottom(-0.5);
  return view;
}

std::unique_ptr<FarmClient> start(const std::vector<std::string>& coordinators, FarmListener& listener,
                                  Duration timeout = seconds(30)) {
  auto client = FarmClient::start(
      {.coordinators = coordinators, .scene = "plain", .museum = "test", .timeout = timeout}, listener);
  CHECK(client);
  return *std::move(client);
}

TEST(FarmClient, opens_a_session_and_delivers_complete_frames_in_order) {
  FakeFarm farm;
  RecordingFarmListener listener;
  const auto client = start({farm.address()}, listener);
  ASSERT_TRUE(listener.wait([](const auto& seen) { return seen.opened == 1; }));
  EXPECT_EQ(listener.seen().scene.title(), "A plain room");
  EXPECT_EQ(farm.last_open().scene(), "plain");
  EXPECT_EQ(farm.last_open().museum(), "test");
  for (std::uint64_t n = 1; n <= 3; ++n) {
    client->request(view_of(n));
    ASSERT_TRUE(listener.wait([&](const auto& seen) { return seen.frames.size() == n; }));
  }
  client->stop();
  const auto seen = listener.seen();
  for (const auto& frame : seen.frames) {
    EXPECT_TRUE(frame.end.complete());
    EXPECT_EQ(frame.tiles.size(), 6u);
    const std::string& jpeg = frame.tiles.front().jpeg();
    const auto pixels = JpegDecoder().decode(std::as_bytes(std::span(jpeg)), 1 << 20);
    ASSERT_TRUE(pixels);
    std::uint8_t rgb[3];
    FakeFarm::colour_of(frame.view.number(), rgb);
    EXPECT_NEAR(pixels->at(5, 5)[1], rgb[1], 4);
  }
}

TEST(FarmClient, has_two_frames_in_flight_and_skips_to_the_newest_view) {
  FakeFarm farm;
  farm.set_gate(false);
  RecordingFarmListener listener;
  const auto client = start({farm.address()}, listener);
  ASSERT_TRUE(listener.wait([](const auto& seen) { return seen.opened == 1; }));
  client->request(view_of(1));
  ASSERT_TRUE(farm.wait_for_views(1));
  client->request(view_of(2));
  ASSERT_TRUE(farm.wait_for_views(2));
  EXPECT_FALSE(client->request(view_of(3)));
  for (std::uint64_t n = 4; n <= 50; ++n) EXPECT_TRUE(client->request(view_of(n)));
  farm.set_gate(true);
  ASSERT_TRUE(listener.wait([](const auto& seen) { return seen.frames.size() == 3; }));
  ASSERT_EQ(farm.views().size(), 3u);
  EXPECT_EQ(farm.views().back().number(), 50u);
  EXPECT_EQ(listener.seen().frames.back().view.number(), 50u);
}

TEST(FarmClient, reconnects_and_requests_again_after_the_coordinator_restarts) {
  auto farm = std::make_unique<FakeFarm>();
  farm->set_gate(false);
  const int port = farm->port();
  RecordingFarmListener listener;
  const auto client = start({farm->address()}, listener);
  ASSERT_TRUE(listener.wait([](const auto& seen) { return seen.opened == 1; }));
  client->request(view_of(1));
  ASSERT_TRUE(farm->wait_for_views(1));
  farm.reset();
  ASSERT_TRUE(listener.wait([](const auto& seen) { return !seen.reasons.empty(); }));
  farm = std::make_unique<FakeFarm>(fake_scene("plain"), port);
  ASSERT_TRUE(listener.wait([](const auto& seen) { return seen.frames.size() == 1; }));
  EXPECT_EQ(listener.seen().opened, 2);
  EXPECT_TRUE(listener.seen().frames.front().end.complete());
}

TEST(FarmClient, ends_a_broken_frame_and_delivers_it_completely_afterwards) {
  FakeFarm farm;
  farm.break_next_frame_after(2);
  RecordingFarmListener listener;
  const auto client = start({farm.address()}, listener);
  client->request(view_of(1));
  ASSERT_TRUE(listener.wait([](const auto& seen) { return seen.frames.size() == 2; }));
  const auto seen = listener.seen();
  EXPECT_FALSE(seen.frames[0].end.complete());
  EXPECT_THAT(seen.frames[0].end.reason(), HasSubstr(farm.address()));
  EXPECT_EQ(seen.frames[0].tiles.size(), 2u);
  EXPECT_TRUE(seen.frames[1].end.complete());
  EXPECT_EQ(seen.frames[1].view.number(), 1u);
}

TEST(FarmClient, tries_the_next_coordinator_when_one_is_away) {
  std::string away;
  { away = FakeFarm().address(); }
  FakeFarm farm;
  RecordingFarmListener listener;
  const auto client = start({away, farm.address()}, listener);
  ASSERT_TRUE(listener.wait([](const auto& seen) { return seen.opened == 1; }));
  EXPECT_THAT(listener.seen().reasons.front(), HasSubstr(away));
}

TEST(FarmClient, reports_a_refusal_once_and_keeps_trying) {
  FakeFarm farm;
  farm.refuse_sessions({grpc::StatusCode::NOT_FOUND, "no scene 'plain'"});
  RecordingFarmListener listener;
  const auto client = start({farm.address()}, listener);
  ASSERT_TRUE(listener.wait([&](const auto&) { return farm.sessions() >= 3; }));
  EXPECT_EQ(listener.seen().reasons.size(), 1u);
  EXPECT_THAT(listener.seen().reasons.front(), HasSubstr("no scene 'plain'"));
  farm.refuse_sessions(grpc::Status::OK);
  ASSERT_TRUE(listener.wait([](const auto& seen) { return seen.opened == 1; }));
}

TEST(FarmClient, disconnects_from_a_coordinator_that_does_not_answer) {
  FakeFarm farm;
  farm.set_gate(false);
  RecordingFarmListener listener;
  const auto client = start({farm.address()}, listener, std::chrono::milliseconds(50));
  client->request(view_of(1));
  ASSERT_TRUE(listener.wait([](const auto& seen) { return !seen.reasons.empty(); }));
  EXPECT_THAT(listener.seen().reasons.front(), HasSubstr("did not answer"));
  farm.set_gate(true);
  ASSERT_TRUE(
      listener.wait([](const auto& seen) { return !seen.frames.empty() && seen.frames.back().end.complete(); }));
}

TEST(FarmClient, reconnects_after_an_unreadable_message) {
  wire::SceneDescription garbage = fake_scene("plain");
  garbage.set_title("\xff");  // A string that is not UTF-8 makes the message invalid.
  FakeFarm farm(garbage);
  RecordingFarmListener listener;
  const auto client = start({farm.address()}, listener);
  ASSERT_TRUE(listener.wait([](const auto& seen) { return !seen.reasons.empty(); }));
  EXPECT_THAT(listener.seen().reasons.front(), HasSubstr("cannot be read"));
}

TEST(FarmClient, refuses_a_scene_without_a_walkable_area) {
  wire::SceneDescription scene = fake_scene("plain");
  scene.set_walking_scale(std::numeric_limits<double>::quiet_NaN());
  FakeFarm farm(scene);
  RecordingFarmListener listener;
  const auto client = start({farm.address()}, listener);
  ASSERT_TRUE(listener.wait([](const auto& seen) { return !seen.reasons.empty(); }));
  EXPECT_THAT(listener.seen().reasons.front(), HasSubstr("walking_scale"));
  EXPECT_EQ(listener.seen().opened, 0);
}

TEST(FarmClient, can_be_stopped_at_any_moment_and_twice) {
  FakeFarm farm;
  farm.set_gate(false);
  RecordingFarmListener listener;
  for (int i = 0; i < 5; ++i) {
    const auto client = start({farm.address()}, listener);
    client->request(view_of(1));
    if (i % 2 == 0) {
      ASSERT_TRUE(farm.wait_for_views(static_cast<std::size_t>(i / 2 + 1)));
    }
    client->stop();
    client->stop();
  }
}

TEST(FarmClient, refuses_to_start_without_a_valid_address) {
  RecordingFarmListener listener;
  EXPECT_EQ(FarmClient::start({}, listener).error().code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(FarmClient::start({.coordinators = {"::1:7401"}}, listener).error().code(), ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace cyclorama::client
