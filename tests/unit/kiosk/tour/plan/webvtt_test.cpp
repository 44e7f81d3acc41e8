// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/plan/webvtt.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cyclorama::tour {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

std::string refused(const std::string& text) {
  const auto cues = parse_webvtt(text, "a.vtt");
  return cues ? "accepted" : cues.error().message();
}

TEST(Webvtt, gives_each_caption_its_time_and_its_plain_text) {
  const auto cues = parse_webvtt(
      "\xEF\xBB\xBFWEBVTT - The cave\r\nKind: captions\r\n\r\nNOTE by the curator\r\n\r\nSTYLE\r\n::cue { color: red "
      "}\r\n\r\n"
      "1\r\n00:01.500 --> 00:04.000 line:90% align:start\r\n<v Ann>Clay &amp; <i>sand</i>\r\n  in layers\r\n\r\n"
      "00:01:00.000 --> 00:01:02.250\r\n第158窟\r\n\r\n01:05.000 --> 01:06.000\r\n",
      "a.vtt");
  ASSERT_TRUE(cues) << cues.error().message();
  ASSERT_EQ(cues->size(), 2u) << "a caption without text is none";
  EXPECT_EQ(cues->at(0), (Cue{1500ms, 4s, "Clay & sand\nin layers"}));
  EXPECT_EQ(cues->at(1), (Cue{60s, 62250ms, "第158窟"}));
}

TEST(Webvtt, of_any_other_form_is_refused_with_its_line_and_the_remedy) {
  EXPECT_THAT(refused(""), HasSubstr("a.vtt:0: a file of captions begins with the line WEBVTT"));
  EXPECT_THAT(refused("WEBVTTX\n"), HasSubstr("WEBVTT"));
  EXPECT_THAT(refused("WEBVTT\n\nname\ntext\n"), HasSubstr("a.vtt:4: a caption needs a line with its times"));
  EXPECT_THAT(refused("WEBVTT\n\n1.5 --> 00:02.000\nx\n"), HasSubstr("a.vtt:3: times have the form"));
  EXPECT_THAT(refused("WEBVTT\n\n00:61.000 --> 02:02.000\nx\n"), HasSubstr("times have the form"));
  EXPECT_THAT(refused("WEBVTT\n\n00:03.000 --> 00:02.000\nx\n"), HasSubstr("ends before it begins"));
  EXPECT_THAT(refused("WEBVTT\n\n00:03.000 --> 09:00:00.000\nx\n"), HasSubstr("after 60 minutes"));
  EXPECT_THAT(refused("WEBVTT\n\n00:03.000 --> 00:04.000\nx\n\n00:02.000 --> 00:04.000\ny\n"),
              HasSubstr("a.vtt:6: the caption begins before the one above"));
  EXPECT_THAT(refused("WEBVTT\n\n00:01.000 --> 00:02.000\nx\n00:02.000 --> 00:03.000\ny\n"),
              HasSubstr("a.vtt:5: an empty line is missing"));
  EXPECT_THAT(refused("WEBVTT\n\n00:01.000 --> 00:02.000\n\xC3\x28\n"), HasSubstr("a.vtt:4: has control characters"));
}

TEST(Webvtt, refuses_a_caption_of_10000_letters_with_the_number_that_is_allowed) {
  std::string text = "WEBVTT\n\n00:01.000 --> 00:02.000\n";
  for (int i = 0; i < 10000; ++i) text += "佛";
  EXPECT_THAT(refused(text), HasSubstr("a.vtt:3: the caption has 10000 letters; at most 300 are allowed"));
}

TEST(Webvtt, refuses_more_captions_than_any_narration_has) {
  std::string text = "WEBVTT\n";
  for (std::size_t i = 0; i <= kMaxCues; ++i) text += "\n00:01.000 --> 00:02.000\nx\n";
  EXPECT_THAT(refused(text), HasSubstr("at most 2000"));
}

}  // namespace
}  // namespace cyclorama::tour
