// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/trade/plot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace cyclorama::render {
namespace {

using testing::HasSubstr;

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

Plot plot_of(std::vector<std::array<double, 2>> points) {
  return {"time, ms", "error", {{"points", "#123456", std::move(points), true, 3.0}}};
}

TEST(PlotSvg, places_points_by_their_logarithms) {
  // The axes extend to round numbers beyond the data, 0.5 to 200, so 10 is in the middle of both.
  const std::string svg = plot_svg("t", {plot_of({{1, 1}, {10, 10}, {100, 100}})});
  EXPECT_THAT(svg, HasSubstr("<circle cx='260.0' cy='234.0' r='3' fill='#123456'/>"));
  EXPECT_THAT(svg, HasSubstr(">0.5</text>"));
  EXPECT_THAT(svg, HasSubstr(">200</text>"));
}

TEST(PlotSvg, a_long_axis_has_room_for_its_labels) {
  const std::string svg = plot_svg("t", {plot_of({{1e-7, 1}, {1e8, 10}})});
  EXPECT_LT(count(svg, "text-anchor='middle'"), 12u);
  EXPECT_GE(count(svg, "text-anchor='middle'"), 6u);
  EXPECT_EQ(count(svg, "r='3'"), 2u);
}

TEST(PlotSvg, leaves_out_values_without_a_logarithm) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const std::string svg = plot_svg("t", {plot_of({{1, 2}, {0, 1}, {1, -1}, {kNan, 1}, {1, kInfinite}})});
  EXPECT_EQ(count(svg, "r='3'"), 1u);
  EXPECT_EQ(count(svg, "nan") + count(svg, "inf"), 0u);
}

TEST(PlotSvg, accepts_an_empty_plot) {
  EXPECT_THAT(plot_svg("t", {plot_of({})}), HasSubstr("</svg>"));
  EXPECT_THAT(plot_svg("t", {}), HasSubstr("</svg>"));
}

TEST(PlotSvg, escapes_text) { EXPECT_THAT(plot_svg("a<b & c", {}), HasSubstr("a&lt;b &amp; c")); }

}  // namespace
}  // namespace cyclorama::render
