// SPDX-License-Identifier: Apache-2.0
// Tests of the settings that the packages install (systemd/settings). As installed, each file lacks one required
// setting, which the error must name; every commented line must be valid.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <regex>

#include "common/base/file.h"
#include "renderfarm/coordinator/coordinator_config.h"
#include "renderfarm/node/node_config.h"

namespace cyclorama {
namespace {

using testing::HasSubstr;

std::string shipped(const char* name) {
  const char* const source = std::getenv("CYCLORAMA_SOURCE");  // NOLINT(concurrency-mt-unsafe)
  const auto text = read_text_file(std::filesystem::path(source) / "systemd/settings" / name, 1 << 20);
  EXPECT_TRUE(text);
  return *text;
}

/// Removes the '#' from every line that shows a key, as an operator would.
std::string uncommented(const std::string& text) {
  return std::regex_replace(text, std::regex("(^|\n)#(\\[|[a-z_]+ = )"), "$1$2");
}

TEST(ShippedSettings, of_the_coordinator_lack_only_the_scenes) {
  const auto options = coordinator::parse_coordinator_config(shipped("farm.toml"), "/etc/cyclorama/farm.toml");
  ASSERT_FALSE(options);
  EXPECT_THAT(options.error().message(), HasSubstr("[[scene]]"));
  EXPECT_THAT(options.error().message(), HasSubstr("/etc/cyclorama/farm.toml"));
  EXPECT_TRUE(coordinator::parse_coordinator_config(
      shipped("farm.toml") + "\n[[scene]]\nname = \"a\"\npath = \"/srv/a\"\n", "farm.toml"));
}

TEST(ShippedSettings, of_a_node_lack_only_the_coordinator) {
  const auto options = node::parse_node_config(shipped("node.toml"), "node.toml");
  ASSERT_TRUE(options) << options.error().message();
  const auto whole = node::complete(*options);
  ASSERT_FALSE(whole);
  EXPECT_THAT(whole.error().message(), HasSubstr("'coordinators' in node.toml"));
}

TEST(ShippedSettings, show_only_existing_keys) {
  const auto coordinator =
      coordinator::parse_coordinator_config(uncommented(shipped("farm.toml")), "/etc/cyclorama/farm.toml");
  ASSERT_TRUE(coordinator) << coordinator.error().message();
  EXPECT_EQ(coordinator->limits.nodes, coordinator::CoordinatorLimits{}.nodes);
  EXPECT_EQ(coordinator->limits.sessions, coordinator::CoordinatorLimits{}.sessions);
  const auto node = node::parse_node_config(uncommented(shipped("node.toml")), "/etc/cyclorama/node.toml");
  ASSERT_TRUE(node) << node.error().message();
  EXPECT_TRUE(node::complete(*node));
}

}  // namespace
}  // namespace cyclorama
