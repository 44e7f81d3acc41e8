// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/make_output.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/memory_file.h"

namespace cyclorama::display {
namespace {

using ::testing::HasSubstr;

TEST(MakeOutput, reads_the_connector_of_a_projector) {
  const auto plain = parse_head("left=HDMI-A-1");
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->projector, "left");
  EXPECT_EQ(plain->connector, "HDMI-A-1");
  EXPECT_EQ(plain->rotation, output::Rotation::kNone);
  const auto turned = parse_head("a=b=1:DP-2,270");
  ASSERT_TRUE(turned);
  EXPECT_EQ(turned->projector, "a=b");
  EXPECT_EQ(turned->connector, "1:DP-2");
  EXPECT_EQ(turned->rotation, output::Rotation::kThreeQuarters);
  EXPECT_EQ(parse_head("left=,180")->rotation, output::Rotation::kHalf);
}

TEST(MakeOutput, refuses_an_invalid_connector) {
  for (const char* wrong :
       {"", "left", "=DP-1", "left=DP-1,45", "left=DP-1,360", "left=DP-1,-90", "left=DP-1,", "left=x:DP-1"}) {
    const auto head = parse_head(wrong);
    ASSERT_FALSE(head) << wrong;
    EXPECT_EQ(head.error().code(), ErrorCode::kInvalidArgument);
    EXPECT_THAT(head.error().message(), HasSubstr("write "));
  }
}

Installation two_projectors() {
  Installation installation;
  for (const char* const name : {"left", "right"})
    installation.projectors.push_back({name, Pinhole::from_field_of_view(64, 48, 1.0), {}, {}, {}});
  return installation;
}

TEST(MakeOutput, uses_the_connectors_of_the_installation) {
  Installation installation = two_projectors();
  installation.projectors[0].plug = {.card = 1, .connector = "DP-2", .turn_deg = 90};
  installation.projectors[1].plug = {.connector = "HDMI-A-1", .turn_deg = 180};
  installation.cards = {"/dev/dri/card1"};
  const auto options = drm_options({}, installation, 50.0);
  ASSERT_TRUE(options);
  EXPECT_EQ(options->heads[0].connector, "1:DP-2");
  EXPECT_EQ(options->heads[0].rotation, output::Rotation::kQuarter);
  EXPECT_EQ(options->heads[0].mode.name, "left");
  EXPECT_EQ(options->heads[1].connector, "HDMI-A-1");
  EXPECT_EQ(options->heads[1].rotation, output::Rotation::kHalf);
  EXPECT_EQ(options->cards, installation.cards);
  EXPECT_EQ(options->refresh_hz, 50.0);
}

TEST(MakeOutput, finds_projectors_by_serial_and_refuses_a_damaged_edid) {
  Installation installation = two_projectors();
  installation.projectors[0].plug = {.serial = "X4K1"};
  installation.projectors[1].plug = {.connector = "HDMI-A-1"};
  const auto options = drm_options({}, installation, 50.0);
  ASSERT_TRUE(options);
  EXPECT_EQ(options->heads[0].serial, "X4K1");
  EXPECT_EQ(options->heads[0].connector, "");
  EXPECT_FALSE(options->heads[1].edid);
  OutputChoice choice;
  choice.heads = {*parse_head("left=DP-3")};
  EXPECT_EQ(drm_options(choice, installation, 50.0)->heads[0].serial, "");
  const MemoryFile damaged("no EDID");
  installation.projectors[1].plug.edid = damaged.path();
  EXPECT_THAT(drm_options({}, installation, 50.0).error().message(), HasSubstr("an EDID of 7 bytes"));
}

TEST(MakeOutput, prefers_the_command_line_to_the_installation) {
  Installation installation = two_projectors();
  installation.projectors[0].plug = {.card = 1, .connector = "DP-2", .turn_deg = 90};
  installation.projectors[1].plug = {.connector = "HDMI-A-1", .turn_deg = 180};
  installation.cards = {"/dev/dri/card1"};
  OutputChoice choice;
  choice.heads = {*parse_head("left=DP-3")};
  choice.cards = {"/dev/dri/card0"};
  const auto options = drm_options(choice, installation, 60.0);
  ASSERT_TRUE(options);
  EXPECT_EQ(options->heads[0].connector, "DP-3");
  EXPECT_EQ(options->heads[0].rotation, output::Rotation::kNone);
  EXPECT_EQ(options->heads[1].connector, "HDMI-A-1");
  EXPECT_EQ(options->heads[1].rotation, output::Rotation::kHalf);
  EXPECT_EQ(options->cards, choice.cards);
}

TEST(MakeOutput, accepts_installed_projectors_only) {
  OutputChoice choice;
  choice.kind = OutputChoice::Kind::kDrm;
  choice.heads = {*parse_head("middle=DP-1")};
  const SteadyClock clock;
  const auto output = make_output(choice, two_projectors(), 60.0, clock);
  ASSERT_FALSE(output);
  EXPECT_THAT(output.error().message(), HasSubstr("'middle' is no projector"));
}

}  // namespace
}  // namespace cyclorama::display
