// SPDX-License-Identifier: Apache-2.0
// systemd/settings/farm.toml, which the package installs: as it is, it lacks the scenes and nothing else, and each line
// that it shows as a comment is right.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <regex>

#include "common/base/file.h"
#include "renderfarm/head/head_config.h"

namespace cyclorama {
namespace {

using testing::HasSubstr;

std::string shipped() {
  const char* const source = std::getenv("CYCLORAMA_SOURCE");  // NOLINT(concurrency-mt-unsafe)
  const auto text = read_text_file(std::filesystem::path(source) / "systemd/settings/farm.toml", 1 << 20);
  EXPECT_TRUE(text);
  return *text;
}

TEST(ShippedSettings, lack_the_scenes_and_nothing_else) {
  const auto options = parse_head_config(shipped(), "/etc/cyclorama/farm.toml");
  ASSERT_FALSE(options);
  EXPECT_THAT(options.error().message(), HasSubstr("[[scene]]"));
  EXPECT_THAT(options.error().message(), HasSubstr("/etc/cyclorama/farm.toml"));
  EXPECT_TRUE(parse_head_config(shipped() + "\n[[scene]]\nname = \"a\"\npath = \"/srv/a\"\n", "farm.toml"));
}

TEST(ShippedSettings, show_only_keys_that_there_are) {
  const std::string text = std::regex_replace(shipped(), std::regex("(^|\n)#(\\[|[a-z_]+ = )"), "$1$2");
  EXPECT_NE(text, shipped());
  const auto options = parse_head_config(text, "/etc/cyclorama/farm.toml");
  ASSERT_TRUE(options) << options.error().message();
  EXPECT_EQ(options->limits.nodes, HeadLimits{}.nodes);
  EXPECT_EQ(options->limits.sessions, HeadLimits{}.sessions);
}

}  // namespace
}  // namespace cyclorama
