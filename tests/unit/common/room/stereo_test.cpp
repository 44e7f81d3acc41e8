// SPDX-License-Identifier: Apache-2.0
#include "common/room/stereo.h"

#include <gtest/gtest.h>

namespace cyclorama {
namespace {

constexpr StereoPacking kPackings[] = {StereoPacking::kSideBySide, StereoPacking::kTopBottom,
                                       StereoPacking::kFrameSequential};

TEST(Stereo, two_eyes_share_a_head_without_a_gap) {
  EXPECT_EQ(part_of_eye(StereoPacking::kSideBySide, Eye::kLeft, 640, 480), (HeadPart{0, 0, 320, 480}));
  EXPECT_EQ(part_of_eye(StereoPacking::kSideBySide, Eye::kRight, 640, 480), (HeadPart{320, 0, 320, 480}));
  EXPECT_EQ(part_of_eye(StereoPacking::kTopBottom, Eye::kLeft, 640, 480), (HeadPart{0, 0, 640, 240}));
  EXPECT_EQ(part_of_eye(StereoPacking::kTopBottom, Eye::kRight, 640, 480), (HeadPart{0, 240, 640, 240}));
  for (const Eye eye : {Eye::kLeft, Eye::kRight}) {
    EXPECT_EQ(part_of_eye(StereoPacking::kFrameSequential, eye, 641, 479), (HeadPart{0, 0, 641, 479}));
  }
}

TEST(Stereo, alternates_eyes_for_any_count) {
  EXPECT_EQ(eye_at(0), Eye::kLeft);
  EXPECT_EQ(eye_at(1), Eye::kRight);
  EXPECT_EQ(eye_at(-1), Eye::kRight);
  EXPECT_EQ(eye_at(-2), Eye::kLeft);
  EXPECT_EQ(eye_at(std::int64_t{1} << 62), Eye::kLeft);
}

TEST(Stereo, an_eyes_pixels_are_where_the_head_draws_them) {
  Pinhole head = Pinhole::from_field_of_view(640, 480, 1.0);
  head.centre_u_px += 31.0;
  head.centre_v_px -= 170.0;
  for (const StereoPacking packing : kPackings) {
    const Pinhole eye = lens_of_eye(head, packing);
    const HeadPart part = part_of_eye(packing, Eye::kLeft, 640, 480);
    EXPECT_EQ(eye.width_px, part.width_px);
    EXPECT_EQ(eye.height_px, part.height_px);
    for (const auto& [u, v] : {std::pair(0.0, 0.0), {17.5, 100.5}, {320.0, 240.0}, {640.0, 480.0}}) {
      const double eye_u = u * part.width_px / 640.0;
      const double eye_v = v * part.height_px / 480.0;
      EXPECT_LT((eye.direction_at(eye_u, eye_v) - head.direction_at(u, v)).norm(), 1e-12);
      const auto pixel = eye.pixel_of(2.5 * head.direction_at(u, v));
      ASSERT_TRUE(pixel);
      EXPECT_LT((*pixel - Eigen::Vector2d(eye_u, eye_v)).norm(), 1e-9);
    }
  }
}

}  // namespace
}  // namespace cyclorama
