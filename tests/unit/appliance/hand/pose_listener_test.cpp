// SPDX-License-Identifier: Apache-2.0
/// Over real sockets of this machine: the listener receives what our tracker sends.
#include "appliance/hand/pose_listener.h"

#include <gtest/gtest.h>
#include <poll.h>

#include "appliance/tracker/interchange/osc_pose.h"
#include "appliance/tracker/interchange/pose_sender.h"

namespace cyclorama::hand {
namespace {

using namespace std::chrono_literals;

const TimePoint kNow(100s);

PoseListener listener() {
  auto listener = PoseListener::open("[::1]:0", "[::1]:0", "Cyclorama0");
  CHECK(listener);
  return *std::move(listener);
}

std::string at(int port) { return "[::1]:" + std::to_string(port); }

/// Takes until something has arrived, for at most two seconds.
ReceivedPoses hear(PoseListener& listener, TimePoint now = kNow) {
  for (int i = 0; i < 200; ++i) {
    ReceivedPoses heard = listener.take(now);
    if (!heard.poses.empty() || heard.steer || heard.stop) return heard;
    ::poll(nullptr, 0, 10);
  }
  return {};
}

tracker::PoseReport pose(std::int32_t sensor, bool found = true) {
  return {sensor, 1, 2'000'000'000, found, {0.1, 0.2, 1.0}, {1, 0, 0, 0}};
}

TEST(PoseListener, receives_what_our_tracker_sends_in_both_protocols) {
  PoseListener ears = listener();
  for (const bool osc : {true, false}) {
    const auto mouth =
        tracker::PoseSender::open(osc ? at(ears.osc_port()) : "", osc ? "" : at(ears.vrpn_port()), "Cyclorama0");
    ASSERT_TRUE(mouth) << mouth.error().message();
    mouth->say(pose(4));
    const ReceivedPoses heard = hear(ears);
    ASSERT_EQ(heard.poses.size(), 1u);
    EXPECT_EQ(heard.poses.front(), pose(4));
  }
}

TEST(PoseListener, receives_a_request) {
  PoseListener ears = listener();
  const auto socket = tracker::DatagramSender::open(at(ears.osc_port()));
  ASSERT_TRUE(socket);
  socket->send(tracker::encode_osc({"/cyclorama/steer", {1.0f, 0.0f, -0.25f}}));
  EXPECT_EQ(hear(ears).steer, (std::array<double, 3>{1.0, 0.0, -0.25}));
}

TEST(PoseListener, receives_a_request_for_a_stop) {
  PoseListener ears = listener();
  const auto socket = tracker::DatagramSender::open(at(ears.osc_port()));
  ASSERT_TRUE(socket);
  socket->send(tracker::encode_osc({"/cyclorama/stop", {-1}}));
  EXPECT_EQ(hear(ears).stop, tracker::OscStop(-1));
  socket->send(tracker::encode_osc({"/cyclorama/stop", {std::string("buddha")}}));
  EXPECT_EQ(hear(ears).stop, tracker::OscStop(std::string("buddha")));
}

TEST(PoseListener, follows_the_first_sensor_until_it_has_been_silent_for_a_second) {
  PoseListener ears = listener();
  const auto mouth = tracker::PoseSender::open(at(ears.osc_port()), "", "");
  ASSERT_TRUE(mouth);
  mouth->say(pose(1));
  EXPECT_EQ(hear(ears).poses.front().sensor, 1);
  mouth->say(pose(2));
  mouth->say(pose(1));
  const ReceivedPoses both = hear(ears, kNow + 900ms);
  ASSERT_EQ(both.poses.size(), 1u);
  EXPECT_EQ(both.poses.front().sensor, 1);
  mouth->say(pose(2));
  EXPECT_EQ(hear(ears, kNow + 2s).poses.front().sensor, 2);
}

TEST(PoseListener, counts_invalid_packets_and_continues) {
  PoseListener ears = listener();
  for (const int port : {ears.osc_port(), ears.vrpn_port()}) {
    const auto socket = tracker::DatagramSender::open(at(port));
    ASSERT_TRUE(socket);
    socket->send(std::vector<std::byte>(13, std::byte{0x2f}));
  }
  const auto mouth = tracker::PoseSender::open(at(ears.osc_port()), "", "");
  mouth->say(pose(1));
  EXPECT_EQ(hear(ears).poses.size(), 1u);
  EXPECT_EQ(ears.refused(), 2u);
}

TEST(PoseListener, reports_that_the_port_is_in_use) {
  PoseListener ears = listener();
  const auto second = PoseListener::open(at(ears.osc_port()), "", "");
  ASSERT_FALSE(second);
  EXPECT_FALSE(PoseListener::open("nowhere", "", ""));
}

}  // namespace
}  // namespace cyclorama::hand
