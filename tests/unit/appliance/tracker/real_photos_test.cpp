// SPDX-License-Identifier: Apache-2.0
/// The detector and the pose on photographs of other projects.
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "appliance/tags/tag_detector.h"
#include "appliance/tracker/overlay.h"
#include "appliance/tracker/tag_pose.h"
#include "common/image/image_file.h"
#include "tests/data_sets/shared_data.h"

namespace cyclorama::tracker {
namespace {

using Corners = std::array<Eigen::Vector2d, 4>;

std::vector<tags::TagDetection> found_in(const std::filesystem::path& photo, const tags::DetectorSettings& settings) {
  auto detector = tags::TagDetector::create(settings);
  const auto picture = read_grey_image(photo, kPhotoLimitPx);
  EXPECT_TRUE(detector.has_value() && picture.has_value()) << photo;
  if (!detector || !picture) return {};
  auto found = detector->detect(*picture);
  return found ? *std::move(found) : std::vector<tags::TagDetection>{};
}

/// Returns the maximum distance of a corner from its position in `listed`, for the best detection of that id; infinite
/// if there is none.
double distance_px(const std::vector<tags::TagDetection>& found, int id, const Corners& listed) {
  double best = std::numeric_limits<double>::infinity();
  for (const tags::TagDetection& tag : found) {
    if (tag.id != id) continue;
    double worst = 0.0;
    for (std::size_t i = 0; i < 4; ++i) worst = std::max(worst, (tag.corners[i] - listed[i]).norm());
    best = std::min(best, worst);
  }
  return best;
}

/// Settings that read every tag: no decimation, any margin, as many wrong bits as libapriltag's own program allows.
tags::DetectorSettings thorough() {
  tags::DetectorSettings settings;
  settings.decimate = 1.0;
  settings.refine_corners = false;  // The lists contain the library's own corners.
  settings.max_hamming = 2;
  settings.min_margin = 0.0;
  return settings;
}

TEST(RealPhotos, finds_every_tag_of_the_swarmathon_lists_where_it_is_listed) {
  CYCLORAMA_SHARED_DATA(folder, "apriltag/swarmathon");
  tags::DetectorSettings settings = thorough();
  settings.refine_edges = false;  // The lists were made without it.
  int listed = 0;
  double largest = 0.0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".txt") continue;
    const auto found = found_in(std::filesystem::path(entry.path()).replace_extension(".jpg"), settings);
    std::ifstream list(entry.path());
    for (std::string line; std::getline(list, line);) {
      int id = 0;
      std::array<double, 8> c{};
      if (std::sscanf(line.c_str(), "%d, (%lf %lf), (%lf %lf), (%lf %lf), (%lf %lf)", &id, &c[0], &c[1], &c[2], &c[3],
                      &c[4], &c[5], &c[6], &c[7]) != 9) {
        continue;
      }
      ++listed;
      const double distance =
          distance_px(found, id, {Eigen::Vector2d(c[6], c[7]), {c[4], c[5]}, {c[2], c[3]}, {c[0], c[1]}});
      EXPECT_LT(distance, 0.15) << entry.path() << ": " << line;
      largest = std::max(largest, distance);
    }
  }
  EXPECT_EQ(listed, 47);
  std::printf("swarmathon: %d listed, farthest corner %.3f px\n", listed, largest);
}

TEST(RealPhotos, finds_every_tag_that_another_detector_found) {
  CYCLORAMA_SHARED_DATA(folder, "apriltag");
  const auto expected = nlohmann::json::parse(std::ifstream(folder / "expected_libapriltag.json"));
  std::vector<double> distances;
  for (const auto& [name, image] : expected["images"].items()) {
    tags::DetectorSettings settings = thorough();
    settings.family = image["family"].get<std::string>();
    const auto found = found_in(folder / name, settings);
    for (const auto& tag : image["detections"]) {
      Corners listed;
      for (std::size_t i = 0; i < 4; ++i) {
        const auto& corner = tag["corners_lb_rb_rt_lt"][3 - i];
        listed[i] = {corner[0].get<double>(), corner[1].get<double>()};
      }
      // The lists' program has its own JPEG decoder and read the PNG photos as JPEG; refined edges jump with a grey
      // level.
      distances.push_back(distance_px(found, tag["id"].get<int>(), listed));
      EXPECT_LT(distances.back(), 0.4) << name << " tag " << tag["id"];
    }
  }
  ASSERT_EQ(distances.size(), 89U);
  std::sort(distances.begin(), distances.end());
  EXPECT_LT(distances[44], 0.15);
  std::printf("expected_libapriltag.json: 89 listed, corner distance median %.3f, largest %.3f px\n", distances[44],
              distances.back());
}

TEST(RealPhotos, a_tag_turns_by_the_turntables_angle) {
  CYCLORAMA_SHARED_DATA(folder, "apriltag/duckietown");
  // test_info.yaml: K, tag_size. Our lens has square pixels, so corners are converted to such a lens.
  constexpr double kFocalU = 329.8729619143081;
  constexpr double kFocalV = 332.94611303946357;
  const Pinhole lens{1056, 792, kFocalU, 528.0, 396.0};
  std::vector<double> errors_deg;
  for (const int angle : {-70, -60, -40, -20, 0, 20, 40, 60, 70}) {
    const auto found = found_in(folder / ("test_image_rotation_" + std::to_string(angle) + ".png"), thorough());
    ASSERT_EQ(found.size(), 1U);
    Corners corners = found[0].corners;
    for (Eigen::Vector2d& corner : corners) corner.y() = 396.0 + (corner.y() - 396.0) * kFocalU / kFocalV;
    const auto poses = estimate_poses(corners, 0.065, lens);
    ASSERT_TRUE(poses.has_value());
    // The series counts anticlockwise seen from above; we count clockwise.
    errors_deg.push_back(yaw_rad(poses->best.T_camera_tag) * 180.0 / std::numbers::pi + angle);
  }
  const double mean =
      std::accumulate(errors_deg.begin(), errors_deg.end(), 0.0) / static_cast<double>(errors_deg.size());
  double squares = 0.0;
  for (const double error : errors_deg) {
    squares += (error - mean) * (error - mean);
    EXPECT_LT(std::abs(error), 4.0);
  }
  const double deviation = std::sqrt(squares / static_cast<double>(errors_deg.size()));
  // The mean is the stand's initial yaw; the deviation from it is the error.
  EXPECT_LT(deviation, 1.6);
  std::printf("duckietown rotation: yaw error mean %.2f, deviation %.2f degrees\n", mean, deviation);
}

}  // namespace
}  // namespace cyclorama::tracker
