// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/make_output.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cyclorama {
namespace {

using ::testing::HasSubstr;

TEST(MakeOutput, reads_where_a_projector_hangs) {
  const auto plain = parse_head("left=HDMI-A-1");
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->projector, "left");
  EXPECT_EQ(plain->connector, "HDMI-A-1");
  EXPECT_EQ(plain->rotation, Rotation::kNone);
  const auto turned = parse_head("a=b=1:DP-2,270");
  ASSERT_TRUE(turned);
  EXPECT_EQ(turned->projector, "a=b");
  EXPECT_EQ(turned->connector, "1:DP-2");
  EXPECT_EQ(turned->rotation, Rotation::kThreeQuarters);
  EXPECT_EQ(parse_head("left=,180")->rotation, Rotation::kHalf);
}

TEST(MakeOutput, refuses_what_names_no_place) {
  for (const char* wrong :
       {"", "left", "=DP-1", "left=DP-1,45", "left=DP-1,360", "left=DP-1,-90", "left=DP-1,", "left=x:DP-1"}) {
    const auto head = parse_head(wrong);
    ASSERT_FALSE(head) << wrong;
    EXPECT_EQ(head.error().code(), ErrorCode::kInvalidArgument);
    EXPECT_THAT(head.error().message(), HasSubstr("write "));
  }
}

TEST(MakeOutput, knows_only_installed_projectors) {
  Installation installation;
  installation.projectors.push_back({"left", Pinhole::from_field_of_view(64, 48, 1.0), {}});
  OutputChoice choice;
  choice.kind = OutputChoice::Kind::kDrm;
  choice.heads = {*parse_head("right=DP-1")};
  const SteadyClock clock;
  const auto output = make_output(choice, installation, 60.0, clock);
  ASSERT_FALSE(output);
  EXPECT_THAT(output.error().message(), HasSubstr("'right' is no projector"));
}

}  // namespace
}  // namespace cyclorama
