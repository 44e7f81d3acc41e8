// SPDX-License-Identifier: Apache-2.0
#include "common/base/named_number.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cyclorama {
namespace {

TEST(NamedNumber, is_a_name_and_a_finite_number) {
  const auto level = parse_named_number("butter lamps=0.25");
  ASSERT_TRUE(level);
  EXPECT_EQ(level->name, "butter lamps");
  EXPECT_EQ(level->number, 0.25);
  EXPECT_EQ(parse_named_number("a=b=-2e3")->name, "a=b");
  for (const char* const wrong : {"", "daylight", "=1", "daylight=", "daylight=x", "daylight=1x", "daylight=nan",
                                  "daylight=inf", "daylight= 1"}) {
    const auto parsed = parse_named_number(wrong);
    ASSERT_FALSE(parsed) << wrong;
    EXPECT_THAT(parsed.error().message(), testing::HasSubstr("write for example"));
  }
}

}  // namespace
}  // namespace cyclorama
