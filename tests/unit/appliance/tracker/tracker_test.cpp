// SPDX-License-Identifier: Apache-2.0
/// The whole tracker against a tour that listens, disconnects and returns.
#include "appliance/tracker/tracker.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <condition_variable>
#include <filesystem>

#include "common/image/draw.h"
#include "common/image/png.h"
#include "common/wire/channel.h"
#include "common/wire/museum.grpc.pb.h"
#include "tests/data_sets/visitor_stories.h"

namespace cyclorama::tracker {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::HasSubstr;

/// Records what a tracker sends.
class FakeTour final : public wire::Tour::Service {
 public:
  grpc::Status Track(grpc::ServerContext*, grpc::ServerReader<wire::TrackedPose>* reader, wire::TrackReply*) override {
    wire::TrackedPose pose;
    while (reader->Read(&pose)) {
      const std::lock_guard lock(mutex_);
      poses_.push_back(pose);
      arrived_.notify_all();
    }
    return grpc::Status::OK;
  }
  /// Returns the first `count` poses, or fewer after twenty seconds.
  std::vector<wire::TrackedPose> wait_for(std::size_t count) {
    std::unique_lock lock(mutex_);
    arrived_.wait_for(lock, seconds(20), [&] { return poses_.size() >= count; });
    return poses_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::vector<wire::TrackedPose> poses_;
};

std::unique_ptr<WireServer> serve(FakeTour* tour, const std::string& address) {
  auto server = WireServer::start(address, {tour});
  EXPECT_TRUE(server.has_value()) << server.error().message();
  return server ? *std::move(server) : nullptr;
}

/// Calls supervise() until the state contains `text`, for at most twenty seconds.
bool comes_to_say(Tracker* tracker, const std::string& text) {
  const SteadyClock clock;
  for (const TimePoint until = clock.now() + seconds(20); clock.now() < until;) {
    static_cast<void>(tracker->supervise());
    if (tracker->state().find(text) != std::string::npos) return true;
    clock.wait_until(clock.now() + milliseconds(20));
  }
  return false;
}

class TrackerTest : public testing::Test {
 protected:
  std::unique_ptr<Tracker> started() {
    auto tracker = Tracker::start(settings_, clock_, &inspection_);
    EXPECT_TRUE(tracker.has_value()) << tracker.error().message();
    return tracker ? *std::move(tracker) : nullptr;
  }
  SteadyClock clock_;
  InspectionService inspection_{"tracker"};
  TrackerSettings settings_;
};

TEST_F(TrackerTest, sends_a_pose_for_each_picture_with_its_stages) {
  FakeTour tour;
  const auto server = serve(&tour, "[::1]:0");
  ASSERT_NE(server, nullptr);
  settings_.tour = "[::1]:" + std::to_string(server->port());
  settings_.name = "left";
  const auto tracker = started();
  ASSERT_NE(tracker, nullptr);
  const auto poses = tour.wait_for(5);
  ASSERT_GE(poses.size(), 5U);
  for (const wire::TrackedPose& pose : poses) {
    EXPECT_EQ(pose.camera(), "left");
    ASSERT_TRUE(pose.found());
    EXPECT_EQ(pose.tag(), 0U);
    EXPECT_NEAR(pose.position_m().z(), 1.0, 0.1);
    EXPECT_GT(pose.shutter_ns(), 0);
    const double norm = pose.rotation_w() * pose.rotation_w() + pose.rotation_x() * pose.rotation_x() +
                        pose.rotation_y() * pose.rotation_y() + pose.rotation_z() * pose.rotation_z();
    EXPECT_NEAR(norm, 1.0, 1e-9);
    ASSERT_EQ(pose.stages_size(), 3);
    EXPECT_EQ(pose.stages(0).name(), "capture");
    EXPECT_EQ(pose.stages(1).name(), "detect");
    EXPECT_EQ(pose.stages(2).name(), "pose");
  }
  EXPECT_GT(poses[4].sequence(), poses[3].sequence());
  EXPECT_TRUE(comes_to_say(tracker.get(), "Follows tag 0"));
  EXPECT_TRUE(inspection_.status().healthy());
  server->stop(milliseconds(0));
}

TEST_F(TrackerTest, follows_a_visitor_who_carries_nothing) {
  // The first 7.5 s of the story as photos, 15 per second.
  const std::filesystem::path folder = testing::TempDir() + "visitor-photos-" + std::to_string(::getpid());
  std::filesystem::create_directories(folder);
  const VisitorRoom room(Pinhole::from_field_of_view(160, 120, settings_.lens.field_of_view_rad), 3);
  const VisitorStory story;
  for (int i = 0; i < 112; ++i) {
    const GreyImage picture = room.picture({story.visitor.at(i / 15.0)}, {}, static_cast<std::uint64_t>(i));
    ASSERT_TRUE(write_png(folder / fmt::format("{:03}.png", i), to_rgb(picture)));
  }
  FakeTour tour;
  const auto server = serve(&tour, "[::1]:0");
  ASSERT_NE(server, nullptr);
  settings_.tour = "[::1]:" + std::to_string(server->port());
  settings_.camera = "file:" + folder.string() + "?frames_per_second=15&loop=no";
  settings_.steer_by = SteerBy::kBody;
  {
    const auto tracker = started();
    ASSERT_NE(tracker, nullptr);
    EXPECT_TRUE(comes_to_say(tracker.get(), "By the body: follows a visitor"));
  }
  std::filesystem::remove_all(folder);
  bool followed = false;
  for (const wire::TrackedPose& pose : tour.wait_for(1)) {
    EXPECT_EQ(pose.body(), pose.found());
    ASSERT_EQ(pose.stages_size(), 3);
    if (!pose.found()) continue;
    followed = true;
    EXPECT_NEAR(pose.position_m().z(), 2.03, 0.3);
    EXPECT_EQ(pose.covariance_size(), 21);
  }
  EXPECT_TRUE(followed);
  server->stop(milliseconds(0));
}

TEST_F(TrackerTest, reconnects_to_a_tour_that_was_away) {
  FakeTour first;
  auto server = serve(&first, "[::1]:0");
  ASSERT_NE(server, nullptr);
  settings_.tour = "[::1]:" + std::to_string(server->port());
  const auto tracker = started();
  ASSERT_NE(tracker, nullptr);
  EXPECT_GE(first.wait_for(2).size(), 2U);
  server->stop(milliseconds(0));
  server.reset();
  EXPECT_TRUE(comes_to_say(tracker.get(), "does not answer"));
  EXPECT_FALSE(inspection_.status().healthy());
  FakeTour second;
  server = serve(&second, settings_.tour);
  ASSERT_NE(server, nullptr);
  EXPECT_GE(second.wait_for(2).size(), 2U);
  EXPECT_TRUE(tracker->supervise());
  server->stop(milliseconds(0));
}

TEST_F(TrackerTest, runs_without_camera_and_tour_and_reports_it) {
  settings_.camera = "file:/nowhere/at/all.png";
  settings_.tour = "[::1]:1";
  const auto tracker = started();
  ASSERT_NE(tracker, nullptr);
  EXPECT_TRUE(comes_to_say(tracker.get(), "No pictures: opening '/nowhere/at/all.png'"));
  EXPECT_THAT(tracker->state(), HasSubstr("The tour at [::1]:1 does not answer"));
  EXPECT_TRUE(tracker->supervise());
  EXPECT_FALSE(inspection_.status().healthy());
}

TEST_F(TrackerTest, refuses_settings_that_can_never_work) {
  settings_.camera = "webcam:0";
  EXPECT_FALSE(Tracker::start(settings_, clock_, &inspection_).has_value());
  settings_.camera = "simulated";
  settings_.tour = "localhost";
  EXPECT_FALSE(Tracker::start(settings_, clock_, &inspection_).has_value());
  settings_.tour = "[::1]:1";
  settings_.detector.family = "aruco";
  EXPECT_FALSE(Tracker::start(settings_, clock_, &inspection_).has_value());
}

TEST_F(TrackerTest, publishes_its_picture_only_while_somebody_watches) {
  settings_.tour = "[::1]:1";
  auto server = WireServer::start("[::1]:0", {&inspection_});
  ASSERT_TRUE(server.has_value());
  const auto tracker = started();
  ASSERT_NE(tracker, nullptr);
  auto channel = make_channel("[::1]:" + std::to_string((*server)->port()));
  ASSERT_TRUE(channel.has_value());
  const auto stub = wire::Inspection::NewStub(*channel);
  wire::PictureRequest request;
  request.set_name("camera");
  const auto ask = [&](wire::Picture* ret_picture) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + seconds(5));
    return stub->GetPicture(&context, request, ret_picture);
  };
  wire::Picture picture;
  EXPECT_EQ(ask(&picture).error_code(), grpc::StatusCode::NOT_FOUND) << "nobody had asked before";
  for (const TimePoint until = clock_.now() + seconds(20); picture.jpeg().empty() && clock_.now() < until;) {
    static_cast<void>(ask(&picture));
  }
  EXPECT_EQ(picture.width_px(), 640U);
  EXPECT_GT(picture.jpeg().size(), 1000U);
  (*server)->stop(milliseconds(0));
}

}  // namespace
}  // namespace cyclorama::tracker
