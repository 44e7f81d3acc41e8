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

std::vector<ConnectorPreference> with_serials(std::initializer_list<const char*> serials) {
  std::vector<ConnectorPreference> preferences;
  for (const char* serial : serials) preferences.push_back({std::nullopt, "", serial});
  return preferences;
}

TEST(HeadPlacement, finds_projectors_by_their_serials_on_any_connector) {
  const auto heads = with_serials({"A", "B"});
  std::vector<AvailableConnector> seen{{{0, "DP-1"}, true, "B"}, {{0, "DP-2"}, false}, {{1, "DP-1"}, true, "A"}};
  const Placed first = assign_connectors(heads, seen, {});
  EXPECT_EQ(first, (Placed{ConnectorId{1, "DP-1"}, ConnectorId{0, "DP-1"}}));
  // The cables are swapped.
  std::swap(seen[0].serial, seen[2].serial);
  const Placed second = assign_connectors(heads, seen, first);
  EXPECT_EQ(second, (Placed{ConnectorId{0, "DP-1"}, ConnectorId{1, "DP-1"}}));
  // One lamp is off, and the other's cable goes into its connector.
  seen[0] = {{0, "DP-1"}, true, "B"};
  seen[2] = {{1, "DP-1"}, false, ""};
  EXPECT_EQ(assign_connectors(heads, seen, second), (Placed{std::nullopt, ConnectorId{0, "DP-1"}}));
}

TEST(HeadPlacement, never_gives_a_head_with_a_serial_another_projector) {
  std::vector<AvailableConnector> seen{{{0, "DP-1"}, true, "C"}, {{0, "DP-2"}, true, ""}};
  EXPECT_EQ(assign_connectors(with_serials({"A"}), seen, {}), (Placed{std::nullopt}));
  seen[0].serial = "A";
  const Placed placed = assign_connectors(with_serials({"A"}), seen, {});
  seen[0] = {{0, "DP-1"}, false, ""};
  EXPECT_EQ(assign_connectors(with_serials({"A"}), seen, placed), placed);
}

TEST(HeadPlacement, leaves_a_named_connector_to_its_head_and_equal_serials_where_they_are) {
  std::vector<ConnectorPreference> heads{{std::nullopt, "", "A"}, {std::nullopt, "DP-1", ""}};
  const std::vector<AvailableConnector> seen{
      {{0, "DP-1"}, true, "A"}, {{0, "DP-2"}, true, "A"}, {{0, "DP-3"}, true, "A"}};
  EXPECT_EQ(assign_connectors(heads, seen, {}), (Placed{ConnectorId{0, "DP-2"}, ConnectorId{0, "DP-1"}}));
  const Placed before{ConnectorId{0, "DP-3"}, ConnectorId{0, "DP-1"}};
  EXPECT_EQ(assign_connectors(heads, seen, before), before);
}

}  // namespace
}  // namespace cyclorama::output
