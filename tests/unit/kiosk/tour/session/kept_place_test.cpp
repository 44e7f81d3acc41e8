// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/session/kept_place.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cyclorama {
namespace {

using testing::HasSubstr;

TEST(KeptPlace, comes_back_as_it_was) {
  for (const KeptPlace& place :
       {KeptPlace{"grotto", {1.25, -3.5}, 0.7}, KeptPlace{"", {0.1, 1e-7}, -0.3},
        KeptPlace{"a \"b\" \\ c\n\t\x7f", {-123456.789, 2.0}, 100.0}, KeptPlace{"Höhle 窟", {1.0 / 3.0, 0.0}, -0.0}}) {
    const auto read = parse_kept_place(to_text(place), "place.toml");
    ASSERT_TRUE(read) << read.error().message() << to_text(place);
    EXPECT_EQ(*read, place);
  }
}

TEST(KeptPlace, refuses_what_is_no_place) {
  for (const char* const text : {"", "scene = \"x\"\n", "scene = \"x\"\nx_m = nan\nz_m = 0\nheading_rad = 0\n",
                                 "scene = \"x\"\nx_m = 1e9\nz_m = 0\nheading_rad = 0\n",
                                 "scene = \"x\"\nx_m = 1\nz_m = 0\nheading_rad = 0\nmore = 1\n", "\x01\x02"}) {
    const auto read = parse_kept_place(text, "place.toml");
    ASSERT_FALSE(read) << text;
    EXPECT_THAT(read.error().message(), HasSubstr("place.toml"));
  }
}

}  // namespace
}  // namespace cyclorama
