// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/governor/pareto_front_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cyclorama::governor {
namespace {

using testing::HasSubstr;

std::string refusal_of(const std::string& text) {
  const auto front = parse_pareto_front(text, "pareto_front.toml");
  return front ? "none" : front.error().message();
}

constexpr const char* kPoint = "[[point]]\ncpu_us_per_px = 2\nerror = 0.5\n";

TEST(ParetoFrontFile, omitted_keys_have_defaults) {
  const auto front = parse_pareto_front(kPoint, "pareto_front.toml");
  ASSERT_TRUE(front) << front.error().message();
  ASSERT_EQ(front->size(), 1u);
  EXPECT_EQ((*front)[0].cost, 2.0);
  EXPECT_EQ((*front)[0].error, 0.5);
  EXPECT_EQ((*front)[0].quality, render::PictureQuality{});
}

TEST(ParetoFrontFile, survives_a_round_trip_bit_by_bit) {
  std::vector<ParetoPoint> points(2);
  points[0].cost = 1.0 / 3.0;
  points[0].error = 0.1;
  points[1] = {{{.samples = 7,
                 .bounces = 3,
                 .light_samples = 2,
                 .firefly_limit = 0.1f,
                 .adaptive_error = 1.0f / 3.0f,
                 .adaptive_minimum = 9,
                 .stored_light = true},
                2.0 / 3.0,
                true,
                71,
                false},
               1e6,
               1e-9};
  const ParetoFront front = *ParetoFront::make(points);
  const std::string text = pareto_front_text(front, "Made by hand.\nTwo lines.");
  EXPECT_THAT(text, testing::StartsWith("# Made by hand.\n# Two lines.\n\n[[point]]\n"));
  const auto again = parse_pareto_front(text, "pareto_front.toml");
  ASSERT_TRUE(again) << again.error().message();
  ASSERT_EQ(again->size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ((*again)[i].cost, front[i].cost);
    EXPECT_EQ((*again)[i].error, front[i].error);
    EXPECT_EQ((*again)[i].quality, front[i].quality);
  }
}

TEST(ParetoFrontFile, the_standard_front_can_be_written_and_read) {
  const auto again = parse_pareto_front(pareto_front_text(ParetoFront::standard(), ""), "pareto_front.toml");
  ASSERT_TRUE(again) << again.error().message();
  EXPECT_EQ(again->size(), ParetoFront::standard().size());
}

TEST(ParetoFrontFile, names_the_line_of_a_mistake_and_the_remedy) {
  EXPECT_THAT(refusal_of(std::string(kPoint) + "samples = 0\n"),
              testing::AllOf(HasSubstr("pareto_front.toml:4"), HasSubstr("samples"), HasSubstr("65536")));
  EXPECT_THAT(refusal_of(std::string(kPoint) + "scale = 1.5\n"), HasSubstr("pareto_front.toml:4"));
  EXPECT_THAT(refusal_of(std::string(kPoint) + "samples = 1.5\n"), HasSubstr("whole number"));
  EXPECT_THAT(refusal_of(std::string(kPoint) + "denoise = 1\n"), HasSubstr("true or false"));
  EXPECT_THAT(refusal_of(std::string(kPoint) + "colour = 1\n"), HasSubstr("colour"));
  EXPECT_THAT(refusal_of("[[point]]\nerror = 1\n"),
              testing::AllOf(HasSubstr("pareto_front.toml:1"), HasSubstr("cpu_us_per_px")));
  EXPECT_THAT(refusal_of("[[point]]\ncpu_us_per_px = 0\nerror = 1\n"), HasSubstr("pareto_front.toml:2"));
  EXPECT_THAT(refusal_of("[[point]]\ncpu_us_per_px = nan\nerror = 1\n"), HasSubstr("pareto_front.toml:2"));
  EXPECT_THAT(refusal_of("[[point]]\ncpu_us_per_px = 1\nerror = -1\n"), HasSubstr("pareto_front.toml:3"));
  EXPECT_THAT(refusal_of("point = 3\n"), HasSubstr("[[point]]"));
  EXPECT_THAT(refusal_of("not toml"), HasSubstr("pareto_front.toml:1"));
}

TEST(ParetoFrontFile, without_a_point_explains_how_to_make_one) {
  EXPECT_THAT(refusal_of(""), HasSubstr("cyclorama-bench-render trade"));
}

TEST(ParetoFrontFile, reports_a_missing_file) {
  EXPECT_EQ(read_pareto_front(testing::TempDir() + "/no/pareto_front.toml").error().code(), ErrorCode::kNotFound);
}

}  // namespace
}  // namespace cyclorama::governor
