// SPDX-License-Identifier: Apache-2.0
#include "common/base/text_lines.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace cyclorama {
namespace {

std::vector<std::string> lines_of(std::string_view text) {
  LineReader reader(text);
  std::vector<std::string> lines;
  for (std::string_view line; reader.next(&line);) lines.emplace_back(line);
  return lines;
}

using Lines = std::vector<std::string>;

TEST(LineReader, accepts_line_ends_of_unix_windows_and_old_macs) {
  EXPECT_EQ(lines_of("a\nb\n"), (Lines{"a", "b"}));
  EXPECT_EQ(lines_of("a\r\nb\r\n"), (Lines{"a", "b"}));
  EXPECT_EQ(lines_of("a\rb\r"), (Lines{"a", "b"}));
  EXPECT_EQ(lines_of("a\nb"), (Lines{"a", "b"}));
  EXPECT_EQ(lines_of("\n\na\n\n"), (Lines{"", "", "a", ""}));
  EXPECT_EQ(lines_of(""), Lines{});
}

TEST(LineReader, binary_data_after_an_old_mac_header_keeps_its_first_byte) {
  LineReader reader("ply\rend_header\r\nX");
  std::string_view line;
  ASSERT_TRUE(reader.next(&line));
  ASSERT_TRUE(reader.next(&line));
  EXPECT_EQ(line, "end_header");
  EXPECT_EQ(reader.offset(), 15u);
}

TEST(LineReader, a_windows_line_end_after_unix_ones_is_one_end) {
  LineReader reader("ply\nend_header\r\nX");
  std::string_view line;
  ASSERT_TRUE(reader.next(&line));
  ASSERT_TRUE(reader.next(&line));
  EXPECT_EQ(reader.offset(), 16u);
}

TEST(Words, are_returned_one_by_one) {
  std::string_view text = "  f\t1/2  -3 ";
  EXPECT_EQ(next_word(&text), "f");
  EXPECT_EQ(next_word(&text), "1/2");
  EXPECT_EQ(next_word(&text), "-3");
  EXPECT_EQ(next_word(&text), "");
  EXPECT_EQ(trimmed(" \t a b \r\n"), "a b");
  EXPECT_EQ(trimmed("  "), "");
}

TEST(Numbers, are_read_up_to_the_first_invalid_character) {
  bool whole = false;
  EXPECT_EQ(number_in("+2.e1", &whole), 20.0);
  EXPECT_TRUE(whole);
  EXPECT_EQ(number_in("3.1+e2", &whole), 3.1);
  EXPECT_FALSE(whole);
  EXPECT_EQ(number_in("x", &whole), std::nullopt);
  EXPECT_EQ(number_in("", &whole), std::nullopt);
  EXPECT_EQ(number_in("1e-999", nullptr), 0.0);
  EXPECT_TRUE(std::isinf(number_in("1e999", nullptr).value_or(0.0)));
  EXPECT_TRUE(std::isnan(number_in("nan", nullptr).value_or(0.0)));
  EXPECT_TRUE(std::isnan(number_in("-1.#IND", &whole).value_or(0.0)));
  EXPECT_TRUE(whole);
}

}  // namespace
}  // namespace cyclorama
