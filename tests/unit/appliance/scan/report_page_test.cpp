// SPDX-License-Identifier: Apache-2.0
#include "appliance/scan/report_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <vector>

#include "appliance/calibration/calibration_file.h"
#include "appliance/scan/wall_plot.h"
#include "common/base/file.h"
#include "tests/data_sets/generated_room.h"

namespace cyclorama::scan {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// Returns true if every element except void ones is closed, in order.
bool is_balanced(const std::string& page) {
  std::vector<std::string> open;
  for (std::size_t at = page.find('<'); at != std::string::npos; at = page.find('<', at + 1)) {
    const std::size_t end = page.find('>', at);
    if (end == std::string::npos) return false;
    const std::string tag = page.substr(at + 1, end - at - 1);
    const std::string name = tag.substr(0, tag.find_first_of(" \n/", 1));
    if (tag.front() == '!' || tag.back() == '/' || name == "meta" || name == "img") continue;
    if (tag.front() != '/') {
      open.push_back(name);
    } else if (open.empty() || "/" + open.back() != tag) {
      return false;
    } else {
      open.pop_back();
    }
  }
  return open.empty();
}

RoomPlan coarse_plan() {
  RoomPlan plan;
  plan.stride_px = 16;
  return plan;
}

calibration::Calibration of_a_room(const GeneratedRoom& room, bool with_wall) {
  solve::CalibrateOptions options;
  options.with_wall = with_wall;
  auto calibration = solve::calibrate(room.measurements(), "2026-11-22T13-05-00Z", options);
  CHECK(calibration.has_value());
  return *std::move(calibration);
}

TEST(ReportPage, describes_a_room_with_plots_in_well_formed_html) {
  const GeneratedRoom room(coarse_plan());
  const calibration::Calibration calibration = of_a_room(room, true);
  ReportFindings findings;
  findings.residuals = wall_residuals(room.measurements(), calibration);
  findings.registration = {0.21, 0.48, 1234};
  findings.photographs = {{"The wall before", {std::byte{0xff}, std::byte{0xd8}, std::byte{0xff}, std::byte{0xe0}}}};
  const std::string page = report_page(calibration, findings);
  EXPECT_TRUE(is_balanced(page));
  EXPECT_THAT(page, AllOf(HasSubstr("0.48 px"), HasSubstr("Residuals"), HasSubstr("Coverage"), HasSubstr("/9j/4A=="),
                          HasSubstr(calibration.projectors[2].name), HasSubstr("class=\"chosen\"")));
  EXPECT_THAT(page,
              AllOf(Not(HasSubstr("nan")), Not(HasSubstr("inf")), Not(HasSubstr("http")), Not(HasSubstr("<script"))))
      << "nothing is loaded";
  EXPECT_LT(page.size(), std::size_t{2} << 20);
  // The page is kept for inspection.
  EXPECT_TRUE(write_file_atomically(std::filesystem::path(::testing::TempDir()) / "cyclorama-report.html", page));
}

TEST(ReportPage, shows_residuals_that_match_the_noise) {
  RoomPlan plan = coarse_plan();
  plan.noise_px = 0.2;
  plan.outliers = 0.0;
  const GeneratedRoom room(plan);
  std::vector<double> errors;
  for (const WallResidual& r : wall_residuals(room.measurements(), of_a_room(room, false), 3000))
    errors.push_back(r.error_px);
  ASSERT_GT(errors.size(), 1000U);
  std::ranges::sort(errors);
  EXPECT_LT(errors[errors.size() / 2], 0.5);  // The median of a Rayleigh distribution with 0.2 px per axis is 0.24.
  EXPECT_GT(errors[errors.size() / 2], 0.1);
}

TEST(ReportPage, is_complete_with_hardly_any_data_and_escapes_names) {
  calibration::Calibration calibration;
  calibration.date = "2026-01-01T00-00-00Z";
  calibration.remarks = {"<script>alert(1)</script> & \"more\""};
  calibration::MeasuredMap map{640, 480, 1, 1, {}, {}, 0.0, 0.0, 0};
  map.directions.assign(4, Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
  map.sigma_px.assign(4, std::numeric_limits<double>::infinity());
  calibration.projectors.push_back({"<b>left</b>", map, true});
  const std::string page = report_page(calibration);
  EXPECT_TRUE(is_balanced(page));
  EXPECT_THAT(page, AllOf(Not(HasSubstr("<script")), Not(HasSubstr("<b>")), HasSubstr("&lt;b&gt;left"),
                          Not(HasSubstr("nan")), Not(HasSubstr("inf"))));
  calibration.projectors.clear();
  EXPECT_TRUE(is_balanced(report_page(calibration)));
}

TEST(ReportPage, lies_beside_the_maps_and_shows_photographs) {
  std::string folder = ::testing::TempDir() + "/report.XXXXXX";
  ASSERT_NE(::mkdtemp(folder.data()), nullptr);
  calibration::Calibration calibration;
  calibration.date = "2026-01-01T00-00-00Z";
  const std::filesystem::path own = calibration::calibration_folder(folder, calibration.date);
  std::filesystem::create_directories(own);
  const std::string jpeg = "jpeg";
  const auto* bytes = reinterpret_cast<const std::byte*>(jpeg.data());
  const ReportFindings::Photograph photograph{"'left' & 'right'", {bytes, bytes + jpeg.size()}};
  const auto path = write_report(folder, calibration, {{}, {}, {photograph, photograph}});
  ASSERT_TRUE(path) << path.error().message();
  EXPECT_EQ(*path, own / "report.html");
  const auto page = read_text_file(*path, 1 << 20);
  ASSERT_TRUE(page);
  EXPECT_THAT(*page, HasSubstr("anBlZw=="));
  EXPECT_THAT(*page, Not(HasSubstr("'left' & 'right'")));
  EXPECT_TRUE(is_balanced(*page));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace cyclorama::scan
