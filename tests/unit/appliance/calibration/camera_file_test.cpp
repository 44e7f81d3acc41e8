// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibration/camera_file.h"

#include <gmock/gmock.h>

#include <cmath>

namespace cyclorama::calibration {
namespace {

using L = MeasuredLens;

CameraFile usual() {
  CameraFile camera{"usb-0000:00:14.0-2",
                    "2026-01-01T00-00-00Z",
                    L::from_focal(1280, 960, 1100.0),
                    LensModel::kRadial2,
                    14,
                    0.05,
                    0.06};
  camera.lens.values[L::kK1] = -0.1;
  camera.lens.values[L::kK2] = 0.02;
  camera.lens.covariance(L::kFocal, L::kK1) = camera.lens.covariance(L::kK1, L::kFocal) = -0.01;
  return camera;
}

TEST(CameraFile, survives_a_round_trip) {
  const std::string written = camera_json(usual());
  const auto read = parse_camera(written, "camera.json");
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(camera_json(*read), written);
  EXPECT_EQ(read->lens.values, usual().lens.values);
  EXPECT_EQ(read->lens.covariance, usual().lens.covariance);
}

TEST(CameraFile, names_the_position_of_a_mistake) {
  struct Case {
    std::string from, to, position;
  };
  const Case cases[] = {{"\"width_px\": 1280", "\"width_px\": 0", "/width_px"},
                        {"\"lens\": \"k1 k2\"", "\"lens\": \"fisheye\"", "/lens"},
                        {"\"version\": 1", "\"version\": 2", "/version"},
                        {"\"views\": 14", "\"views\": 14, \"more\": 1", "more"},
                        {"1100.0", "\"long\"", "/focal_px_centre_px_k1_k2_k3_p1_p2/0"},
                        {"1100.0", "-1100.0", "focal length"},
                        {"3025.0", "-3025.0", "/covariance"},
                        {"-0.1,", "-9.0,", "folds over"}};
  const std::string good = camera_json(usual());
  for (const Case& c : cases) {
    std::string bad = good;
    const auto at = bad.find(c.from);
    ASSERT_NE(at, std::string::npos) << c.from << "\n" << good;
    bad.replace(at, c.from.size(), c.to);
    const auto parsed = parse_camera(bad, "camera.json");
    ASSERT_FALSE(parsed) << c.to;
    EXPECT_EQ(parsed.error().code(), ErrorCode::kBadData);
    EXPECT_THAT(parsed.error().message(), testing::HasSubstr("camera.json: "));
    EXPECT_THAT(parsed.error().message(), testing::HasSubstr(c.position));
  }
}

TEST(CameraFile, refuses_every_truncation) {
  const std::string good = camera_json(usual());
  for (std::size_t length = 0; length + 2 < good.size(); length += 19) {
    EXPECT_FALSE(parse_camera(std::string_view(good).substr(0, length), "camera.json"));
  }
}

TEST(CameraFile, scales_to_another_size_but_not_to_another_aspect_ratio) {
  const MeasuredLens lens = usual().lens;
  const auto half = lens_for_picture(lens, 640, 480);
  ASSERT_TRUE(half) << half.error().message();
  for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(100.0, 80.0), Eigen::Vector2d(900.0, 700.0)}) {
    const auto one = lens.direction_at(pixel);
    const auto other = half->direction_at(0.5 * pixel);
    ASSERT_TRUE(one && other);
    EXPECT_LE((*one - *other).norm(), 1e-12);
  }
  EXPECT_NEAR(half->covariance(L::kFocal, L::kK1), 0.5 * lens.covariance(L::kFocal, L::kK1), 1e-12);
  const auto wide = lens_for_picture(lens, 1280, 720);
  ASSERT_FALSE(wide);
  EXPECT_THAT(wide.error().message(), testing::HasSubstr("calibrated for pictures of 1280x960"));
}

}  // namespace
}  // namespace cyclorama::calibration
