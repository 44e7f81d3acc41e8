// SPDX-License-Identifier: Apache-2.0
#include "common/base/text.h"

#include <gtest/gtest.h>

namespace cyclorama {
namespace {

TEST(Text, a_number_must_fill_the_text) {
  EXPECT_EQ(parse_double("+1.5e3"), 1500.0);
  EXPECT_EQ(parse_integer("-42"), -42);
  for (const char* const wrong : {"", "+", "1,5", "1 ", " 1", "0x10", "1e", "99999999999999999999"}) {
    EXPECT_EQ(parse_integer(wrong), std::nullopt) << wrong;
  }
  EXPECT_EQ(parse_double("1.5m"), std::nullopt);
}

TEST(Text, what_is_printed_holds_no_control_bytes_and_has_an_end) {
  EXPECT_EQ(printable("a\x1b[2J\n\xff"), "a?[2J??");
  EXPECT_EQ(printable("abcdef", 3), "abc...");
  EXPECT_EQ(printable("abc", 3), "abc");
}

}  // namespace
}  // namespace cyclorama
