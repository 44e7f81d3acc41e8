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

TEST(Text, printable_text_has_no_control_bytes_and_a_limited_length) {
  EXPECT_EQ(printable("a\x1b[2J\n\xff"), "a?[2J??");
  EXPECT_EQ(printable("abcdef", 3), "abc...");
  EXPECT_EQ(printable("abc", 3), "abc");
}

TEST(Text, accepts_every_script_and_never_cuts_within_a_character) {
  EXPECT_EQ(printable("莫高窟 é \xf0\x9f\x8f\xaf"), "莫高窟 é \xf0\x9f\x8f\xaf");
  EXPECT_EQ(printable("莫高窟", 8), "莫高...");
  EXPECT_EQ(printable("莫高窟", 9), "莫高窟");
  EXPECT_EQ(printable("莫高窟", 2), "...");
}

TEST(Text, replaces_each_invalid_byte_by_a_question_mark) {
  EXPECT_EQ(printable("\xc3"), "?");       // Cut short.
  EXPECT_EQ(printable("\xc0\x80"), "??");  // Overlong, in two, three and four bytes.
  EXPECT_EQ(printable("\xe0\x80\x80"), "???");
  EXPECT_EQ(printable("\xf0\x80\x80\x80"), "????");
  EXPECT_EQ(printable("\xed\xa0\x80"), "???");       // Half of a surrogate pair.
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), "????");  // Beyond Unicode.
  EXPECT_EQ(printable("\xe8\x8e \x80"), "?? ?");
  EXPECT_EQ(printable("\x7f\xc2\x9b"
                      "31m"),
            "???31m");  // DEL, and an escape sequence in C1.
  EXPECT_EQ(printable("a\xe2\x80\xa8"
                      "b"),
            "a???b");  // Line separator.
}

}  // namespace
}  // namespace cyclorama
