// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/drm/connector_assignment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cyclorama::output {
namespace {

using Placed = std::vector<std::optional<ConnectorId>>;

std::vector<ConnectorPreference> preferences(std::initializer_list<const char*> texts) {
  std::vector<ConnectorPreference> preferences;
  for (const char* text : texts) preferences.push_back(*parse_connector_preference(text));
  return preferences;
}

TEST(HeadPlacement, reads_the_preferred_connector_of_a_head) {
  EXPECT_EQ(parse_connector_preference("HDMI-A-1")->connector, "HDMI-A-1");
  EXPECT_FALSE(parse_connector_preference("HDMI-A-1")->card);
  EXPECT_EQ(parse_connector_preference("1:DP-2")->card, 1U);
  EXPECT_EQ(parse_connector_preference("1:DP-2")->connector, "DP-2");
  EXPECT_TRUE(parse_connector_preference("")->connector.empty());
  for (const char* wrong : {":DP-1", "x:DP-1", "-1:DP-1", "1:", "99:DP-1", "99999999999999999999:DP-1"}) {
    const auto preferred = parse_connector_preference(wrong);
    ASSERT_FALSE(preferred) << wrong;
    EXPECT_THAT(preferred.error().message(), ::testing::HasSubstr("write HDMI-A-1"));
  }
}

TEST(HeadPlacement, assigns_named_connectors_even_when_nothing_is_connected) {
  const std::vector<AvailableConnector> seen{{{0, "DP-1"}, true}, {{0, "DP-2"}, false}, {{1, "DP-1"}, true}};
  EXPECT_EQ(assign_connectors(preferences({"DP-2", "1:DP-1", "DP-1"}), seen, {}),
            (Placed{ConnectorId{0, "DP-2"}, ConnectorId{1, "DP-1"}, ConnectorId{0, "DP-1"}}));
}

TEST(HeadPlacement, assigns_unnamed_connected_connectors_to_the_other_heads) {
  const std::vector<AvailableConnector> seen{{{0, "DP-1"}, true}, {{0, "DP-2"}, false}, {{0, "DP-3"}, true}};
  EXPECT_EQ(assign_connectors(preferences({"", "", "DP-1"}), seen, {}),
            (Placed{ConnectorId{0, "DP-3"}, std::nullopt, ConnectorId{0, "DP-1"}}));
}

TEST(HeadPlacement, never_moves_a_head_that_has_a_connector) {
  std::vector<AvailableConnector> seen{{{0, "DP-1"}, false}, {{0, "DP-2"}, true}};
  const Placed first = assign_connectors(preferences({"", ""}), seen, {});
  EXPECT_EQ(first, (Placed{ConnectorId{0, "DP-2"}, std::nullopt}));
  seen[0].is_connected = true;
  seen[1].is_connected = false;
  const Placed second = assign_connectors(preferences({"", ""}), seen, first);
  EXPECT_EQ(second, (Placed{ConnectorId{0, "DP-2"}, ConnectorId{0, "DP-1"}}));
}

TEST(HeadPlacement, assigns_a_connector_to_one_head_only) {
  const std::vector<AvailableConnector> seen{{{0, "DP-1"}, true}};
  EXPECT_EQ(assign_connectors(preferences({"DP-1", "DP-1", ""}), seen, {}),
            (Placed{ConnectorId{0, "DP-1"}, std::nullopt, std::nullopt}));
}

}  // namespace
}  // namespace cyclorama::output
