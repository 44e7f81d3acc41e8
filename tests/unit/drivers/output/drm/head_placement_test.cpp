// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/drm/head_placement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cyclorama {
namespace {

using Placed = std::vector<std::optional<Socket>>;

std::vector<SocketWish> wishes(std::initializer_list<const char*> texts) {
  std::vector<SocketWish> wishes;
  for (const char* text : texts) wishes.push_back(*parse_socket(text));
  return wishes;
}

TEST(HeadPlacement, reads_what_a_wish_says) {
  EXPECT_EQ(parse_socket("HDMI-A-1")->connector, "HDMI-A-1");
  EXPECT_FALSE(parse_socket("HDMI-A-1")->card);
  EXPECT_EQ(parse_socket("1:DP-2")->card, 1U);
  EXPECT_EQ(parse_socket("1:DP-2")->connector, "DP-2");
  EXPECT_TRUE(parse_socket("")->connector.empty());
  for (const char* wrong : {":DP-1", "x:DP-1", "-1:DP-1", "1:", "99:DP-1", "99999999999999999999:DP-1"}) {
    const auto wish = parse_socket(wrong);
    ASSERT_FALSE(wish) << wrong;
    EXPECT_THAT(wish.error().message(), ::testing::HasSubstr("write HDMI-A-1"));
  }
}

TEST(HeadPlacement, puts_the_named_where_they_belong_even_when_nothing_hangs_there) {
  const std::vector<SeenSocket> seen{{{0, "DP-1"}, true}, {{0, "DP-2"}, false}, {{1, "DP-1"}, true}};
  EXPECT_EQ(place_heads(wishes({"DP-2", "1:DP-1", "DP-1"}), seen, {}),
            (Placed{Socket{0, "DP-2"}, Socket{1, "DP-1"}, Socket{0, "DP-1"}}));
}

TEST(HeadPlacement, gives_the_others_what_is_connected_and_not_named) {
  const std::vector<SeenSocket> seen{{{0, "DP-1"}, true}, {{0, "DP-2"}, false}, {{0, "DP-3"}, true}};
  EXPECT_EQ(place_heads(wishes({"", "", "DP-1"}), seen, {}),
            (Placed{Socket{0, "DP-3"}, std::nullopt, Socket{0, "DP-1"}}));
}

TEST(HeadPlacement, never_moves_a_head_that_has_a_place) {
  std::vector<SeenSocket> seen{{{0, "DP-1"}, false}, {{0, "DP-2"}, true}};
  const Placed first = place_heads(wishes({"", ""}), seen, {});
  EXPECT_EQ(first, (Placed{Socket{0, "DP-2"}, std::nullopt}));
  seen[0].is_connected = true;
  seen[1].is_connected = false;
  const Placed second = place_heads(wishes({"", ""}), seen, first);
  EXPECT_EQ(second, (Placed{Socket{0, "DP-2"}, Socket{0, "DP-1"}}));
}

TEST(HeadPlacement, gives_a_socket_to_one_head_only) {
  const std::vector<SeenSocket> seen{{{0, "DP-1"}, true}};
  EXPECT_EQ(place_heads(wishes({"DP-1", "DP-1", ""}), seen, {}),
            (Placed{Socket{0, "DP-1"}, std::nullopt, std::nullopt}));
}

}  // namespace
}  // namespace cyclorama
