// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/trust/grants.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cyclorama::trust {
namespace {

using testing::HasSubstr;

std::string refusal_of(const std::string& lines) {
  const auto grants = Grants::parse("[[museum]]\nname = \"hall-3\"\n" + lines, "museums.toml");
  return grants ? "" : grants.error().message();
}

TEST(Grants, state_the_rights_of_a_museum) {
  const auto grants = Grants::parse(R"(
[[museum]]
name = "hall-3"
scenes = ["grotto", "relic"]
weight = 2.0
sessions = 1
megabytes_per_s = 20
cores = 16
megapixels_per_s = 60.5
samples = 256
bounces = 0
scene_gib = 0.5
free_eye = true
views_per_day = 1000
places_per_day = 20
watermark = "9e1f2bad2af9ea4e"
[[museum]]
name = "hall-4"
scenes = ["*"]
)",
                                    "museums.toml");
  ASSERT_TRUE(grants) << grants.error().message();
  const Grant* const first = grants->find("hall-3");
  ASSERT_NE(first, nullptr);
  EXPECT_TRUE(first->allows("grotto"));
  EXPECT_FALSE(first->allows("cave"));
  EXPECT_FALSE(first->allows("*"));
  EXPECT_EQ(first->weight, 2.0);
  EXPECT_EQ(first->sessions, 1);
  EXPECT_EQ(first->bytes_per_second, 20e6);
  EXPECT_EQ(first->cores, 16.0);
  EXPECT_EQ(first->megapixels_per_second, 60.5);
  EXPECT_EQ(first->samples, 256);
  EXPECT_EQ(first->bounces, 0);
  EXPECT_EQ(first->scene_bytes, 0x1p29);
  EXPECT_TRUE(first->free_eye);
  EXPECT_EQ(first->views_per_day, 1000);
  EXPECT_EQ(first->places_per_day, 20);
  EXPECT_EQ(first->watermark, 0x9e1f2bad2af9ea4eu);
  EXPECT_EQ(*grants->find("hall-4"), (Grant{.museum = "hall-4", .sessions = 4}));
  EXPECT_TRUE(grants->find("hall-4")->allows("cave"));
  EXPECT_EQ(grants->find("hall-5"), nullptr);
}

TEST(Grants, are_empty_for_an_empty_file) { EXPECT_EQ(Grants::parse("", "museums.toml")->size(), 0u); }

TEST(Grants, name_the_line_of_a_mistake) {
  EXPECT_EQ(refusal_of("scenes = [\"a\"]\n"), "");
  EXPECT_THAT(refusal_of("scenes = []\n"), HasSubstr("museums.toml:3"));
  EXPECT_THAT(refusal_of("scenes = [\"a\", \"*\"]\n"), HasSubstr("alone"));
  EXPECT_THAT(refusal_of(""), HasSubstr("scenes"));
  EXPECT_THAT(refusal_of("scenes = [\"a\"]\nweight = 0\n"), HasSubstr("museums.toml:4"));
  EXPECT_THAT(refusal_of("scenes = [\"a\"]\nkings = 1\n"), HasSubstr("kings"));
  for (const char* const quota :
       {"cores = 0", "megapixels_per_s = 0", "samples = 0", "samples = 4097", "bounces = -1", "bounces = 65",
        "scene_gib = 0", "views_per_day = 0", "places_per_day = 0", "cores = \"many\""}) {
    EXPECT_THAT(refusal_of("scenes = [\"a\"]\n" + std::string(quota) + "\n"), HasSubstr("museums.toml:4")) << quota;
  }
  for (const char* const key : {"", "0000000000000000", "9e1f", "9e1f2bad2af9ea4eff", "xe1f2bad2af9ea4e"}) {
    EXPECT_THAT(refusal_of("scenes = [\"a\"]\nwatermark = \"" + std::string(key) + "\"\n"), HasSubstr("16 hex")) << key;
  }
  EXPECT_THAT(refusal_of("scenes = [\"a\"]\n[[museum]]\nname = \"hall-3\"\nscenes = [\"b\"]\n"), HasSubstr("twice"));
}

}  // namespace
}  // namespace cyclorama::trust
