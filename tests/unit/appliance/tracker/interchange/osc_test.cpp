// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/interchange/osc.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string_view>

#include "appliance/tracker/interchange/osc_pose.h"

namespace cyclorama::tracker {
namespace {

using testing::HasSubstr;

std::vector<std::byte> bytes_of(std::string_view text) {
  std::vector<std::byte> bytes;
  for (const char c : text) bytes.push_back(static_cast<std::byte>(c));
  return bytes;
}

TEST(Osc, agrees_with_the_specifications_examples) {
  // The specification's two examples, byte for byte.
  using namespace std::string_view_literals;
  EXPECT_EQ(encode_osc({"/oscillator/4/frequency", {440.0f}}),
            bytes_of("/oscillator/4/frequency\0,f\0\0\x43\xdc\0\0"sv));
  EXPECT_EQ(
      encode_osc({"/foo", {1000, -1, std::string("hello"), 1.234f, 5.678f}}),
      bytes_of("/foo\0\0\0\0,iisff\0\0\0\0\x03\xe8\xff\xff\xff\xffhello\0\0\0\x3f\x9d\xf3\xb6\x40\xb5\xb2\x2d"sv));
}

TEST(Osc, every_type_survives_a_round_trip) {
  const OscMessage message{"/x",
                           {std::int32_t{-7}, 0.5f, std::string(), std::string("four"), std::vector<std::byte>(5),
                            std::int64_t{1} << 60, -1e300, OscTime{42}, true, false, OscNothing{}}};
  const auto decoded = decode_osc(encode_osc(message));
  ASSERT_TRUE(decoded) << decoded.error().message();
  EXPECT_EQ(*decoded, std::vector<OscMessage>{message});
}

std::vector<std::byte> bundle(const std::vector<std::vector<std::byte>>& parts) {
  using namespace std::string_view_literals;
  auto all = bytes_of("#bundle\0\0\0\0\0\0\0\0\1"sv);
  for (const auto& part : parts) {
    const auto size = static_cast<std::uint32_t>(part.size());
    for (const int shift : {24, 16, 8, 0}) all.push_back(static_cast<std::byte>(size >> shift & 0xff));
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

TEST(Osc, reads_nested_bundles_up_to_a_limit) {
  const OscMessage a{"/a", {1}};
  const OscMessage b{"/b", {}};
  const auto decoded = decode_osc(bundle({encode_osc(a), bundle({encode_osc(b)}), bundle({})}));
  ASSERT_TRUE(decoded);
  EXPECT_EQ(*decoded, (std::vector<OscMessage>{a, b}));
  auto deep = encode_osc(a);
  for (int i = 0; i < 20; ++i) deep = bundle({deep});
  EXPECT_FALSE(decode_osc(deep));
}

TEST(Osc, refuses_invalid_packets) {
  using namespace std::string_view_literals;
  for (const std::string_view text :
       {""sv, "/a"sv, "/abc"sv, "a\0\0\0,\0\0\0"sv, "/a\0\0"sv, "/a\0\0i\0\0\0"sv, "/a\0\0,i\0\0"sv, "/a\0x,\0\0\0"sv,
        "/a\0\0,\0\0\0abcd"sv, "/a\0\0,q\0\0"sv, "/a\0\0,b\0\0\xff\xff\xff\xff"sv, "/a\0\0,b\0\0\0\0\0\1ax\0\0"sv,
        "#bundle\0"sv, "#bungle\0\0\0\0\0\0\0\0\1"sv, "#bundle\0\0\0\0\0\0\0\0\1\0\0\0\x04/a\0"sv,
        "/a\0\0,s\0\0abcd"sv}) {
    const auto decoded = decode_osc(bytes_of(text));
    ASSERT_FALSE(decoded) << testing::PrintToString(text);
    EXPECT_EQ(decoded.error().code(), ErrorCode::kBadData);
    EXPECT_THAT(decoded.error().message(), HasSubstr("no OSC packet"));
  }
}

TEST(OscPose, survives_a_round_trip_bit_by_bit) {
  const PoseReport pose{7, 123456789012, 987654321098765, true, {0.1, -0.2, 1.3}, {0.9, 0.1, -0.2, 0.3}};
  const auto decoded = decode_osc(encode_osc(to_osc(pose)));
  ASSERT_TRUE(decoded);
  EXPECT_EQ(pose_from_osc(decoded->front()), pose);
  PoseReport lost{3, 5, 6, false, {}, {1, 0, 0, 0}};
  EXPECT_EQ(pose_from_osc(to_osc(lost)), lost);
}

TEST(OscPose, reads_numbers_of_any_type_and_ignores_other_messages) {
  const auto pose = pose_from_osc({"/cyclorama/pose", {1.0f, 2, 3.0, 0.5f, 0, 1, 1, 0, 0, 0}});
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->position_m[0], 0.5);
  EXPECT_FALSE(pose_from_osc({"/cyclorama/pose", {1, 2, 3}}));
  EXPECT_FALSE(pose_from_osc({"/cyclorama/lost", {1, std::string("2"), 3}}));
  EXPECT_FALSE(pose_from_osc({"/cyclorama/lost", {1e300, 2, 3}}));
  EXPECT_FALSE(pose_from_osc({"/other/pose", {1, 2, 3}}));
  EXPECT_EQ(steer_from_osc({"/cyclorama/steer", {2.0f, -0.5, 0}}), (std::array<double, 3>{1.0, -0.5, 0.0}));
  EXPECT_FALSE(steer_from_osc({"/cyclorama/steer", {std::nanf(""), 0, 0}}));
  EXPECT_FALSE(steer_from_osc({"/cyclorama/steer", {1, 0}}));
  EXPECT_EQ(stop_from_osc({"/cyclorama/stop", {1.0f}}), OscStop(1));
  EXPECT_FALSE(stop_from_osc({"/cyclorama/stop", {2}}));
  EXPECT_FALSE(stop_from_osc({"/cyclorama/stop", {true, 1}}));
  EXPECT_FALSE(stop_from_osc({"/cyclorama/steer", {1}}));
  EXPECT_EQ(captions_from_osc({"/cyclorama/captions", {1}}), OscCaptions{});
  EXPECT_EQ(captions_from_osc({"/cyclorama/captions", {}}), OscCaptions{std::vector<std::string>()});
  EXPECT_EQ(captions_from_osc({"/cyclorama/captions", {std::string("de"), std::string("zh")}}),
            (OscCaptions{std::vector<std::string>{"de", "zh"}}));
  EXPECT_FALSE(captions_from_osc({"/cyclorama/captions", {2}}));
  EXPECT_FALSE(captions_from_osc({"/cyclorama/captions", {std::string("de"), 1}}));
  EXPECT_FALSE(captions_from_osc({"/cyclorama/stop", {1}}));
}

}  // namespace
}  // namespace cyclorama::tracker
