// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/session/saved_position.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cyclorama::tour {
namespace {

using testing::HasSubstr;

TEST(SavedPosition, survives_a_round_trip) {
  for (const SavedPosition& position :
       {SavedPosition{"grotto", {1.25, -3.5}, 0.7}, SavedPosition{"", {0.1, 1e-7}, -0.3},
        SavedPosition{"a \"b\" \\ c\n\t\x7f", {-123456.789, 2.0}, 100.0},
        SavedPosition{"Höhle 窟", {1.0 / 3.0, 0.0}, -0.0}}) {
    const auto read = parse_saved_position(to_text(position), "place.toml");
    ASSERT_TRUE(read) << read.error().message() << to_text(position);
    EXPECT_EQ(*read, position);
  }
}

TEST(SavedPosition, refuses_an_invalid_position) {
  for (const char* const text : {"", "scene = \"x\"\n", "scene = \"x\"\nx_m = nan\nz_m = 0\nheading_rad = 0\n",
                                 "scene = \"x\"\nx_m = 1e9\nz_m = 0\nheading_rad = 0\n",
                                 "scene = \"x\"\nx_m = 1\nz_m = 0\nheading_rad = 0\nmore = 1\n", "\x01\x02"}) {
    const auto read = parse_saved_position(text, "place.toml");
    ASSERT_FALSE(read) << text;
    EXPECT_THAT(read.error().message(), HasSubstr("place.toml"));
  }
}

}  // namespace
}  // namespace cyclorama::tour
