// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/light_versions.h"

#include <gtest/gtest.h>

#include <string_view>

namespace cyclorama::node {
namespace {

VersionedLight light(const std::string& version) { return {version, 7, std::make_shared<light::LightStore>()}; }

TEST(LightVersions, keeps_the_newest_two) {
  LightVersions lights;
  EXPECT_FALSE(lights.newest());
  for (const char* const version : {"a", "b", "b", "c"}) {
    lights.add(light(version));
    EXPECT_EQ(lights.newest()->version, version);
  }
  EXPECT_FALSE(lights.find("a"));
  EXPECT_TRUE(lights.find("b"));
  EXPECT_TRUE(lights.find("c"));
}

TEST(LightVersions, added_again_is_the_newest) {
  LightVersions lights;
  for (const char* const version : {"a", "b", "a", "c"}) lights.add(light(version));
  EXPECT_TRUE(lights.find("a"));
  EXPECT_FALSE(lights.find("b"));
}

TEST(LightVersions, are_named_by_every_byte_of_the_file) {
  const auto version = [](std::string_view file) { return version_of(std::as_bytes(std::span(file))); };
  EXPECT_EQ(version("light"), version("light"));
  EXPECT_NE(version("light"), version("lighT"));
  EXPECT_EQ(version("").size(), 64u);
}

}  // namespace
}  // namespace cyclorama::node
