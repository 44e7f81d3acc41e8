// SPDX-License-Identifier: Apache-2.0
/// Tests of the printed sheet as a camera sees it: its black areas are rasterised from the PDF and searched for tags.
#include "kiosk/operator/wand_sheet.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "appliance/camera_calibration/board_search.h"
#include "appliance/tags/tag_detector.h"
#include "appliance/tracker/tag_tracking.h"
#include "common/base/text.h"
#include "kiosk/operator/board_sheet.h"

namespace cyclorama::operations {
namespace {

constexpr double kPixelsPerPoint = 2.0;
constexpr double kPixelsPerMm = kPixelsPerPoint * 72.0 / 25.4;

/// Returns the first page's rectangles, black on white.
GreyImage rasterised(const std::string& pdf, const Paper& paper) {
  GreyImage picture(static_cast<int>(paper.width_mm * kPixelsPerMm), static_cast<int>(paper.height_mm * kPixelsPerMm),
                    255);
  const std::size_t begin = pdf.find("stream\n");
  std::istringstream lines(pdf.substr(begin, pdf.find("endstream", begin) - begin));
  double grey = 1.0;
  std::vector<std::pair<double, double>> points;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::vector<std::string> parts;
    for (std::string word; words >> word;) parts.push_back(word);
    if (parts.size() == 2 && parts[1] == "g") grey = *parse_double(parts[0]);
    if (parts.size() == 3 && parts[2] == "m") points.clear();
    if (parts.size() == 3 && (parts[2] == "m" || parts[2] == "l")) {
      points.emplace_back(*parse_double(parts[0]) * kPixelsPerPoint,
                          picture.height() - *parse_double(parts[1]) * kPixelsPerPoint);
    }
    if (line != "h" || grey > 0.0 || points.size() != 4) continue;
    for (int y = 0; y < picture.height(); ++y) {
      if (y + 0.5 < points[0].second || y + 0.5 >= points[2].second) continue;
      for (int x = 0; x < picture.width(); ++x) {
        if (x + 0.5 >= points[0].first && x + 0.5 < points[2].first) *picture.at(x, y) = 0;
      }
    }
  }
  return picture;
}

TEST(BoardSheet, has_all_corners_at_the_right_positions_for_a_camera) {
  for (const Paper& paper : papers()) {
    const GreyImage picture = rasterised(to_pdf(board_sheet(paper)), paper);
    auto detector = camera_calibration::make_board_detector();
    ASSERT_TRUE(detector.has_value());
    const TagBoard board = board_on(paper);
    const auto view = camera_calibration::find_board(picture, {board}, &*detector);
    ASSERT_TRUE(view) << paper.name << ": " << view.error().message();
    ASSERT_EQ(static_cast<int>(view->board_m.size()), board.corners()) << paper.name;
    const Eigen::Vector2d middle_m = 0.5 * (board.corner_m(0) + board.corner_m(board.corners() - 1));
    for (std::size_t i = 0; i < view->board_m.size(); ++i) {
      const Eigen::Vector2d expected =
          1e3 * (view->board_m[i] - middle_m) + 0.5 * Eigen::Vector2d(paper.width_mm, paper.height_mm);
      // The page is cut to whole pixels, and so are edges: the tolerance is 1.4 pixels of 0.18 mm.
      EXPECT_LE((view->camera_px[i] / kPixelsPerMm - expected).norm(), 0.27) << paper.name;
    }
  }
}

TEST(WandSheet, has_all_tags_at_the_right_positions_and_sizes_for_a_detector) {
  for (const Paper& paper : papers()) {
    const GreyImage picture = rasterised(to_pdf(wand_sheet(11, paper)), paper);
    tags::DetectorSettings settings;
    settings.refine_corners = false;
    auto detector = tags::TagDetector::create(settings);
    ASSERT_TRUE(detector.has_value());
    const auto found = detector->detect(picture);
    ASSERT_TRUE(found.has_value());
    ASSERT_EQ(found->size(), 3U) << paper.name;
    const FoldedCard card = card_on(paper);
    for (const tags::TagDetection& tag : *found) {
      const Eigen::Vector2d left = tag.corners[0] / kPixelsPerMm;
      const Eigen::Vector2d right = tag.corners[1] / kPixelsPerMm;
      EXPECT_NEAR((right - left).norm(), 1e3 * card.tag_size_m, 0.3);
      EXPECT_GT(right.x(), left.x());
      const double centre = 0.5 * paper.width_mm + 1e3 * (tag.id - 34) * card.panel_width_m;
      EXPECT_NEAR(0.5 * (left.x() + right.x()), centre, 0.3) << tag.id;
    }
  }
}

TEST(WandSheet, has_a_back_with_the_tag_that_no_wand_has) {
  const Paper& paper = papers()[0];
  const std::vector<VectorPage> pages = wand_sheet(11, paper);
  ASSERT_EQ(pages.size(), 3u);
  tags::DetectorSettings settings;
  settings.refine_corners = false;
  auto detector = tags::TagDetector::create(settings);
  ASSERT_TRUE(detector.has_value());
  const auto found = detector->detect(rasterised(to_pdf({pages[2]}), paper));
  ASSERT_TRUE(found.has_value());
  ASSERT_EQ(found->size(), 1U);
  EXPECT_EQ(found->front().id, kBackTag);
  EXPECT_FALSE(tracker::PatternSettings().pattern_of(kBackTag));
}

TEST(WandSheet, is_a_pdf_whose_table_has_the_right_offsets) {
  const std::string pdf = to_pdf(wand_sheet(0, papers()[0]));
  EXPECT_EQ(pdf.substr(0, 8), "%PDF-1.4");
  EXPECT_EQ(pdf.substr(pdf.size() - 6), "%%EOF\n");
  const std::size_t table = pdf.find("xref\n0 10\n");
  ASSERT_NE(table, std::string::npos);
  for (int i = 1; i < 10; ++i) {
    const auto place = parse_integer(pdf.substr(table + 10 + 20 * static_cast<std::size_t>(i), 10));
    ASSERT_TRUE(place.has_value());
    EXPECT_EQ(pdf.substr(static_cast<std::size_t>(*place), 7), std::to_string(i) + " 0 obj");
  }
  EXPECT_THAT(pdf, testing::HasSubstr("startxref\n" + std::to_string(table)));
}

TEST(VectorPage, escapes_text_in_strings) {
  VectorPage page(100.0, 100.0);
  page.text({10, 10}, 5.0, "a (b) \\ \n\xc3\xa4");
  EXPECT_THAT(to_pdf({page}), testing::HasSubstr("(a \\(b\\) \\\\ ?\?\?) Tj"));
}

}  // namespace
}  // namespace cyclorama::operations
