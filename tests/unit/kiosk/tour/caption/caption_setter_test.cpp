// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/caption/caption_setter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace cyclorama::tour {
namespace {

using testing::HasSubstr;

/// Columns of the page that hold ink, from the first to the last.
std::pair<int, int> inked_columns(const GreyImage& ink, int from_row, int to_row) {
  int first = ink.width();
  int last = -1;
  for (int y = from_row; y < to_row; ++y) {
    for (int x = 0; x < ink.width(); ++x) {
      if (*ink.at(x, y) < 128) continue;
      first = std::min(first, x);
      last = std::max(last, x);
    }
  }
  return {first, last};
}

int inked_pixels(const GreyImage& ink) {
  return static_cast<int>(std::ranges::count_if(ink.data(), [](std::uint8_t value) { return value >= 128; }));
}

class CaptionSetterTest : public testing::Test {
 protected:
  CaptionSetterTest() {
    auto opened = CaptionSetter::open();
    CHECK(opened);
    setter_.emplace(*std::move(opened));
  }
  std::vector<CaptionPage> set(const std::vector<CaptionText>& texts, const CaptionSize& size = {}) {
    auto pages = setter_->set(texts, size);
    EXPECT_TRUE(pages) << pages.error().message();
    return pages ? *std::move(pages) : std::vector<CaptionPage>();
  }
  std::optional<CaptionSetter> setter_;
};

TEST_F(CaptionSetterTest, draws_capital_letters_of_the_requested_height) {
  for (const int letters : {9, 20, 60}) {
    const auto pages = set({{"en", "", "HHH"}}, {letters, 20 * letters, 3});
    ASSERT_EQ(pages.size(), 1u);
    const GreyImage& ink = pages[0].ink;
    int first = ink.height();
    int last = -1;
    for (int y = 0; y < ink.height(); ++y) {
      if (inked_columns(ink, y, y + 1).second < 0) continue;
      first = std::min(first, y);
      last = y;
    }
    EXPECT_NEAR(last - first + 1, letters, 1.01) << letters;
    EXPECT_EQ(pages[0].characters, 3u);
  }
}

TEST_F(CaptionSetterTest, sets_latin_arabic_chinese_and_hebrew_letters) {
  for (const CaptionText& text :
       {CaptionText{"en", "", "Clay on sandstone"}, CaptionText{"ar", "", "الطين على الحجر الرملي"},
        CaptionText{"zh-Hant", "", "佛陀右脅而臥"}, CaptionText{"he", "", "חימר על אבן חול"}}) {
    const auto pages = set({text});
    ASSERT_EQ(pages.size(), 1u) << text.language;
    EXPECT_GT(inked_pixels(pages[0].ink), 200) << text.language;
  }
}

TEST_F(CaptionSetterTest, joins_arabic_letters_as_their_neighbours_demand) {
  // Each letter alone has a final stroke; in a word they share one line.
  const auto joined = set({{"ar", "", "ببب"}});
  const auto alone = set({{"ar", "", "ب ب ب"}});
  ASSERT_TRUE(joined.size() == 1 && alone.size() == 1);
  EXPECT_LT(inked_pixels(joined[0].ink), 0.8 * inked_pixels(alone[0].ink));
}

TEST_F(CaptionSetterTest, begins_lines_at_the_right_where_the_script_does) {
  const auto begins = [&](const std::string& language, const std::string& text) {
    const auto pages = set({{language, "", text}});
    EXPECT_EQ(pages.size(), 1u);
    const GreyImage& ink = pages[0].ink;
    const auto [left, right] = inked_columns(ink, 2 * ink.height() / 3, ink.height());
    return std::pair(left, ink.width() - 1 - right);
  };
  const auto [english_left, english_right] = begins("en", "A line that is much longer\nshort");
  EXPECT_LT(english_left, english_right);
  const auto [arabic_left, arabic_right] = begins("ar", "سطر أطول بكثير من الآخر\nقصير");
  EXPECT_GT(arabic_left, arabic_right);
}

TEST_F(CaptionSetterTest, writes_two_languages_below_each_other) {
  const auto one = set({{"en", "The nirvana", "The Buddha lies on his side."}});
  const auto two = set({{"en", "The nirvana", "The Buddha lies on his side."}, {"zh-Hant", "涅槃", "佛陀右脅而臥。"}});
  ASSERT_TRUE(one.size() == 1 && two.size() == 1);
  EXPECT_GT(two[0].ink.height(), 1.6 * one[0].ink.height());
  EXPECT_EQ(set({{"en", "", ""}, {"de", "", ""}}).size(), 0u);
}

TEST_F(CaptionSetterTest, cuts_a_long_text_into_pages_without_losing_a_letter) {
  std::string text;
  for (int i = 0; i < 100; ++i) text += "word" + std::to_string(i) + " ";
  const auto pages = set({{"en", "", text}}, {12, 300, 4});
  ASSERT_GT(pages.size(), 3u);
  std::size_t characters = 0;
  for (const CaptionPage& page : pages) {
    characters += page.characters;
    EXPECT_LE(page.ink.height(), 6 * 12 * 2);
  }
  EXPECT_EQ(characters, text.size());
}

TEST_F(CaptionSetterTest, names_the_language_whose_letters_no_font_has) {
  const auto pages = setter_->set({{"pqm", "", "\xF0\x93\x80\x80\xF0\x93\x80\x81"}}, {});  // Egyptian hieroglyphs.
  ASSERT_FALSE(pages);
  EXPECT_THAT(pages.error().message(), HasSubstr("2 of the letters of a text in 'pqm'; install"));
}

TEST_F(CaptionSetterTest, refuses_pages_larger_than_a_display_takes) {
  const auto pages = setter_->set({{"en", "", "W\nW\nW\nW\nW\nW"}}, {400, 4000, 6});
  ASSERT_FALSE(pages);
  EXPECT_THAT(pages.error().message(), HasSubstr("4096 x 2048"));
}

}  // namespace
}  // namespace cyclorama::tour
