// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/plan/tour_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <numbers>

#include "common/base/file.h"
#include "kiosk/tour/plan/tour_plan_text.h"

namespace cyclorama::tour {
namespace {

using testing::HasSubstr;

constexpr const char* kHead = "version = 1\nlanguages = [\"en\", \"zh-Hant\"]\n";

std::string stop(const std::string& name, const std::string& position, const std::string& more = "") {
  return "[[stop]]\nname = \"" + name + "\"\nposition_m = " + position + "\nheading_deg = 90\n" + more;
}

WalkableArea room() {
  auto area = WalkableArea::make({{-5, -5}, {5, -5}, {5, 5}, {-5, 5}});
  CHECK(area);
  return *std::move(area);
}

std::string mistake(const std::string& text, const WalkableArea* area = nullptr) {
  const auto plan = parse_tour_plan(text, "tour.toml", area);
  return plan ? "" : plan.error().message();
}

TEST(TourPlan, reads_stops_texts_limits_and_ways) {
  const WalkableArea area = room();
  const auto plan = parse_tour_plan(
      std::string(kHead) +
          "scene = \"grotto\"\n[title]\nen = \"Cave 158\"\nzh-Hant = \"洞窟\"\n"
          "[limits]\nwalk_m_per_s = 0.5\nturn_deg_per_s = 20\neye_height_m = 1.2\n" +
          stop("door", "[0, 4]", "stay_s = 20\nkeep = false\n[stop.title]\nen = \"The door\"\n") +
          stop("well", "[4.5, -4]") + "[[way]]\nfrom = \"well\"\nto = \"door\"\nthrough_m = [[1, 1], [2, 2]]\n",
      "tour.toml", &area);
  ASSERT_TRUE(plan) << plan.error().message();
  EXPECT_EQ(plan->title.at("zh-Hant"), "洞窟");
  ASSERT_EQ(plan->stops.size(), 2u);
  EXPECT_EQ(plan->stops[0].stop.title, "The door");
  EXPECT_EQ(plan->stops[0].stop.stay, std::chrono::seconds(20));
  EXPECT_FALSE(plan->stops[0].keep);
  EXPECT_TRUE(plan->stops[1].keep);
  EXPECT_EQ(plan->stops[1].stop.title, "well") << "without a title, the name";
  EXPECT_DOUBLE_EQ(plan->stops[1].stop.heading_rad, std::numbers::pi / 2);
  ASSERT_EQ(plan->ways.size(), 1u);
  EXPECT_EQ(plan->ways[0].from, 1u);
  EXPECT_EQ(plan->ways[0].through.size(), 2u);

  Site site;
  WalkLimits museum;
  museum.forward_m_per_s = 1.0;
  museum.turn_rad_per_s = 0.1;
  site = with_plan(std::move(site), *plan, museum);
  EXPECT_DOUBLE_EQ(site.pace, 0.5);
  EXPECT_DOUBLE_EQ(site.turn_pace, 1.0) << "never above the museum's own limit";
  EXPECT_EQ(site.stops.size(), 2u);
}

TEST(TourPlan, refuses_a_stop_inside_a_wall_with_the_nearest_place) {
  const WalkableArea area = room();
  EXPECT_THAT(mistake(kHead + stop("a", "[0, 0]") + stop("b", "[7, 1]"), &area),
              testing::AllOf(HasSubstr("tour.toml:9: stop"), HasSubstr("nobody can stand"), HasSubstr("[4.9")));
  EXPECT_THAT(mistake(kHead + stop("a", "[0, 0]") + stop("b", "[1, 1]") +
                          "[[way]]\nfrom = \"a\"\nto = \"b\"\nthrough_m = [[0, 9]]\n",
                      &area),
              HasSubstr("through_m: has (0, 9)"));
  EXPECT_EQ(mistake(kHead + stop("b", "[7, 1]")), "") << "without the scene nobody knows its walls";
}

TEST(TourPlan, names_line_and_remedy_of_every_mistake) {
  const std::string one = stop("a", "[0, 0]");
  struct Wrong {
    std::string text;
    const char* says;
  };
  for (const Wrong& wrong : std::vector<Wrong>{
           {"", "is missing"},
           {"version = 2\nlanguages = [\"en\"]\n" + one, "tour.toml:1: version"},
           {kHead, "at least one [[stop]]"},
           {kHead + one + "[[stop.lamps]]\ngroup = \"sun\"\nlevel = 5\n", "stop[0].lamps[0].level"},
           {kHead + one + "[[stop.lamps]]\ngroup = \"sun\"\nlevel = 0\n[[stop.lamps]]\ngroup = \"sun\"\nlevel = 1\n",
            "'sun' has two levels"},
           {"version = 1\nlanguages = []\n[title]\nde = \"x\"\n" + one, "tour.toml:2: languages: names no language"},
           {"version = 1\nlanguages = [\"english\"]\n" + one, "no language tag"},
           {"version = 1\nlanguages = [\"en\", \"en\"]\n" + one, "twice"},
           {kHead + ("[title]\nzh-Hant = \"x\"\n" + one), "title.en"},
           {kHead + ("[title]\nen = \"" + std::string(201, 'x') + "\"\n" + one), "has 201 bytes; at most 200"},
           {kHead + ("[title]\nen = \"a\\nb\"\n" + one), "one line"},
           {kHead + stop("a", "[0, 0]", "[stop.text]\nen = \"" + std::string(10'000, 'x') + "\"\n"), "at most 4000"},
           {kHead + stop("A", "[0, 0]"), "letters of a to z"},
           {kHead + (one + one), "another stop's"},
           {kHead + stop("a", "[0, 0, 0]"), "position_m"},
           {kHead + stop("a", "[0, 1e99]"), "position_m"},
           {kHead + one + "[[way]]\nfrom = \"a\"\nto = \"b\"\n", "no stop 'b'"},
           {kHead + one + "[[way]]\nfrom = \"a\"\nto = \"a\"\n", "where the way begins"},
           {kHead + one + stop("b", "[1, 1]") +
                "[[way]]\nfrom = \"a\"\nto = \"b\"\nby = \"cut\"\nthrough_m = [[0, 0]]\n",
            "belongs to a walk"},
           {kHead + ("[limits]\nwalk_km_per_h = 3\n" + one), "is not a setting"},
           {kHead + ("[limits]\neye_height_m = 3\n" + one), "eye_height_m"},
           {"stop = [\n", "tour.toml:"},
       }) {
    EXPECT_THAT(mistake(wrong.text), HasSubstr(wrong.says)) << wrong.text;
  }
  std::string many = kHead;
  for (std::size_t i = 0; i <= kMaxPlannedStops; ++i) many += stop("s" + std::to_string(i), "[0, 0]");
  EXPECT_THAT(mistake(many), HasSubstr("at most 256"));
}

TEST(TourPlan, reads_how_it_writes_on_the_wall) {
  const auto plain = parse_tour_plan(kHead + stop("a", "[0, 0]"), "tour.toml");
  ASSERT_TRUE(plain);
  EXPECT_FALSE(plain->captions) << "nothing is written unless the curator says so";
  const std::string captions = std::string(kHead) + "[captions]\n";
  const auto plan = parse_tour_plan(captions + "letters_arcmin = 60\nelevation_deg = -10\n" +
                                        stop("a", "[0, 0]", "[stop.captions]\nzh-Hant = \"a.vtt\"\n"),
                                    "tour.toml");
  ASSERT_TRUE(plan) << plan.error().message();
  EXPECT_EQ(plan->captions->shown, std::vector<std::string>{"en"});
  EXPECT_NEAR(plan->captions->letters_rad, kRadiansPerDegree, 1e-12);
  EXPECT_EQ(plan->stops[0].caption_files.at("zh-Hant"), "a.vtt");
  const auto again = parse_tour_plan(to_toml(*plan), "again.toml");
  ASSERT_TRUE(again) << again.error().message();
  EXPECT_EQ(to_toml(*again), to_toml(*plan));

  EXPECT_THAT(mistake(captions + "show = [\"fr\"]\n" + stop("a", "[0, 0]")), HasSubstr("has 'fr', which is not among"));
  EXPECT_THAT(mistake(captions + "show = [\"en\", \"zh-Hant\", \"en\"]\n" + stop("a", "[0, 0]")),
              HasSubstr("at most 2"));
  EXPECT_THAT(mistake(captions + stop("a", "[0, 0]", "[stop.captions]\nen = \"../secret.vtt\"\n")),
              HasSubstr("name a file beside tour.toml"));
  EXPECT_THAT(mistake(kHead + stop("a", "[0, 0]", "[stop.captions]\nen = \"a.vtt\"\n")),
              HasSubstr("add a table [captions]"));
}

TEST(TourPlan, refuses_a_text_of_10000_letters_with_the_number_that_is_allowed) {
  EXPECT_THAT(mistake(kHead + stop("a", "[0, 0]", "[stop.text]\nen = \"" + std::string(10000, 'x') + "\"\n")),
              HasSubstr("at most 4000"));
}

TEST(TourPlan, of_the_demo_is_one_of_its_grotto) {
  const char* const source = std::getenv("CYCLORAMA_SOURCE");  // NOLINT(concurrency-mt-unsafe): nobody sets it.
  const auto text =
      read_text_file(std::filesystem::path(source != nullptr ? source : ".") / "demo/tour/tour.toml", 1 << 20);
  ASSERT_TRUE(text) << text.error().message();
  // The floor of every generated grotto (renderfarm/generator).
  const auto area = WalkableArea::make(
      {{-8.1, 0.3}, {8.1, 0.3}, {8.1, 3.1}, {0.8, 3.1}, {0.8, 4.6}, {-0.8, 4.6}, {-0.8, 3.1}, {-8.1, 3.1}});
  ASSERT_TRUE(area);
  const auto plan = parse_tour_plan(*text, "tour.toml", &*area);
  ASSERT_TRUE(plan) << plan.error().message();
  for (const PlannedStop& planned : plan->stops) EXPECT_EQ(planned.title.size(), plan->languages.size());
}

TEST(TourPlan, is_written_so_that_it_reads_the_same) {
  const auto plan =
      parse_tour_plan(std::string(kHead) + "keep = false\nscene = \"a \\\"b\\\"\"\n[limits]\nreduced_motion = true\n" +
                          stop("a", "[0.125, -3]", "stay_s = 3\n[stop.text]\nen = \"x\\\\y\"\n") + stop("b", "[1, 1]") +
                          "[[way]]\nfrom = \"a\"\nto = \"b\"\nby = \"cut\"\n",
                      "tour.toml");
  ASSERT_TRUE(plan) << plan.error().message();
  const std::string text = to_toml(*plan);
  const auto again = parse_tour_plan(text, "tour.toml");
  ASSERT_TRUE(again) << again.error().message() << "\n" << text;
  EXPECT_EQ(to_toml(*again), text);
  EXPECT_EQ(again->scene, "a \"b\"");
  EXPECT_EQ(again->stops[0].text.at("en"), "x\\y");
  EXPECT_FALSE(again->stops[1].keep);
  EXPECT_TRUE(again->ways[0].is_cut);
  EXPECT_TRUE(again->reduced_motion);
}

}  // namespace
}  // namespace cyclorama::tour
