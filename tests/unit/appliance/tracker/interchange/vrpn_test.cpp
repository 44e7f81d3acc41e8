// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/interchange/vrpn.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "appliance/tracker/interchange/bytes.h"

namespace cyclorama::tracker {
namespace {

const PoseReport kPose{2, 1, 1'700'000'000'123'456'000, true, {0.1, -0.2, 1.3}, {0.9, 0.1, -0.2, 0.3}};

TEST(Vrpn, a_pose_survives_a_round_trip_bit_by_bit) {
  VrpnReader reader("Cyclorama0");
  const auto read = reader.read(encode_vrpn(kPose, "Cyclorama0"));
  ASSERT_TRUE(read) << read.error().message();
  ASSERT_EQ(read->size(), 1u);
  EXPECT_EQ(read->front(), kPose);
}

TEST(Vrpn, has_the_byte_layout_of_the_protocol) {
  const auto bytes = encode_vrpn(kPose, "T");
  PacketReader reader(bytes);
  EXPECT_EQ(reader.u32(), 24u + 6u) << "the header padded, the body not";
  EXPECT_EQ(reader.u32(), 1'700'000'000u);
  EXPECT_EQ(reader.u32(), 123'456u);
  EXPECT_EQ(reader.i32(), 0) << "the sender that is named";
  EXPECT_EQ(reader.i32(), -1);
  reader.u32();
  EXPECT_EQ(reader.u32(), 2u) << "with its NUL";
  const auto name = reader.bytes(4);
  EXPECT_EQ(name[0], std::byte{'T'});
  EXPECT_TRUE(std::all_of(name.begin() + 1, name.end(), [](std::byte b) { return b == std::byte{0}; }));
  EXPECT_EQ(reader.u32(), 24u + 4u + 22u);
  reader.bytes(20 + 4 + 22 + 6);
  EXPECT_EQ(reader.u32(), 24u + 64u);
  reader.bytes(20);
  EXPECT_EQ(reader.i32(), 2);
  reader.i32();
  for (const double value : {0.1, -0.2, 1.3, 0.1, -0.2, 0.3, 0.9}) EXPECT_EQ(reader.f64(), value) << "w last";
  EXPECT_TRUE(reader.is_empty());
}

TEST(Vrpn, follows_only_the_configured_device) {
  VrpnReader reader("Other");
  EXPECT_TRUE(reader.read(encode_vrpn(kPose, "Cyclorama0"))->empty());
  VrpnReader any("");
  EXPECT_EQ(any.read(encode_vrpn(kPose, "Cyclorama0"))->size(), 1u);
}

TEST(Vrpn, remembers_names_from_an_earlier_datagram) {
  const auto whole = encode_vrpn(kPose, "T");
  constexpr std::size_t kNames = 32 + 56;
  VrpnReader reader("T");
  const std::span<const std::byte> bytes(whole);
  EXPECT_TRUE(reader.read(bytes.subspan(kNames))->empty()) << "whose is it?";
  EXPECT_TRUE(reader.read(bytes.first(kNames))->empty());
  EXPECT_EQ(reader.read(bytes.subspan(kNames))->size(), 1u);
}

TEST(Vrpn, reports_nothing_for_a_sensor_that_is_out_of_sight) {
  PoseReport lost = kPose;
  lost.found = false;
  EXPECT_TRUE(encode_vrpn(lost, "T").empty());
}

TEST(Vrpn, refuses_every_truncated_datagram) {
  const auto whole = encode_vrpn(kPose, "T");
  for (std::size_t size = 1; size < whole.size(); ++size) {
    if (size == 32 || size == 32 + 56) continue;  // The cut is between two messages.
    VrpnReader reader("T");
    EXPECT_FALSE(reader.read(std::span<const std::byte>(whole).first(size))) << size;
  }
}

TEST(PoseReport, is_converted_from_room_axes_to_camera_axes) {
  // To the visitor's right, half a metre up, one metre from the wall; turned to the right by 0.3.
  PoseReport report{1, 1, 1, true, {0.2, 0.5, 1.0}, {std::cos(0.15), 0.0, -std::sin(0.15), 0.0}};
  const auto pose = pose_of(report, TrackerAxes::kRoom);
  ASSERT_TRUE(pose);
  EXPECT_LT((pose->translation() - Eigen::Vector3d(-0.2, -0.5, 1.0)).norm(), 1e-12);
  // The room's y is up: clockwise from above is a negative turn there, and a positive one about the camera's y.
  const Eigen::Vector3d z = pose->rotation() * Eigen::Vector3d::UnitZ();
  EXPECT_NEAR(std::atan2(z.x(), z.z()), 0.3, 1e-12);
  report.rotation = {1.0, 0.0, 0.0, 0.0};
  EXPECT_TRUE(pose_of(report, TrackerAxes::kRoom)->rotation().isApprox(Eigen::Quaterniond::Identity()));
}

TEST(PoseReport, refuses_numbers_that_are_not_finite) {
  PoseReport report{1, 1, 1, true, {0, 0, 1}, {1, 0, 0, 0}};
  EXPECT_TRUE(pose_of(report, TrackerAxes::kCamera));
  report.rotation[0] = 0.5;
  EXPECT_FALSE(pose_of(report, TrackerAxes::kCamera));
  report.rotation[0] = 1.0;
  report.position_m[1] = std::nan("");
  EXPECT_FALSE(pose_of(report, TrackerAxes::kCamera));
}

}  // namespace
}  // namespace cyclorama::tracker
