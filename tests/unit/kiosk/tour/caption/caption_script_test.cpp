// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/caption/caption_script.h"

#include <gtest/gtest.h>

namespace cyclorama::tour {
namespace {

using namespace std::chrono_literals;

constexpr TimePoint kArrival{1000s};

CaptionScript script() {
  CaptionScript script;
  script.since = kArrival;
  script.parts = {{"en", "The foot", "Of clay.", {{2s, 4s, "one"}, {6s, 8s, "two"}}}, {"de", "Der Fuß", "", {}}};
  return script;
}

TEST(CaptionScript, shows_the_stop_until_its_narration_begins_and_after_it_has_ended) {
  for (const Duration time : {0s, 1s, 8s, 100s}) {
    const CaptionMoment moment = caption_at(script(), kArrival + time);
    EXPECT_EQ(moment.texts, (std::vector<CaptionText>{{"en", "The foot", "Of clay."}, {"de", "Der Fuß", ""}}));
  }
  EXPECT_EQ(caption_at(script(), kArrival).until, kArrival + 2s);
  EXPECT_EQ(caption_at(script(), kArrival + 8s).until, std::nullopt);
}

TEST(CaptionScript, follows_the_narration_and_is_silent_where_that_is) {
  const CaptionMoment first = caption_at(script(), kArrival + 3s);
  EXPECT_EQ(first.texts[0], (CaptionText{"en", "", "one", true}));
  EXPECT_EQ(first.texts[1], (CaptionText{"de", "Der Fuß", ""})) << "it has no narration";
  EXPECT_EQ(first.began_at, kArrival + 2s);
  EXPECT_EQ(first.until, kArrival + 4s);
  const CaptionMoment pause = caption_at(script(), kArrival + 5s);
  EXPECT_EQ(pause.texts[0], (CaptionText{"en", "", "", true}));
  EXPECT_EQ(pause.until, kArrival + 6s);
}

TEST(CaptionScript, shows_the_pages_of_a_long_text_one_after_the_other_and_again) {
  std::vector<CaptionPage> pages(2);
  pages[0].characters = 90;   // 10 s.
  pages[1].characters = 190;  // 20 s.
  std::optional<Duration> left;
  EXPECT_EQ(page_at(pages, 0s, &left), 0u);
  EXPECT_EQ(left, 10s);
  EXPECT_EQ(page_at(pages, 12s, &left), 1u);
  EXPECT_EQ(left, 18s);
  EXPECT_EQ(page_at(pages, 31s, &left), 0u);
  EXPECT_EQ(left, 9s);
  pages.pop_back();
  EXPECT_EQ(page_at(pages, 500s, &left), 0u);
  EXPECT_EQ(left, std::nullopt) << "one alone stays";
}

}  // namespace
}  // namespace cyclorama::tour
