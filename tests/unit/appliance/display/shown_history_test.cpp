// SPDX-License-Identifier: Apache-2.0
// A display's record of its pictures: the moments, and the heads' pictures, recomputed by the processor.
#include "appliance/display/shown_history.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "appliance/display/calibrated_heads.h"
#include "appliance/display/head_sampler.h"
#include "appliance/display/present_mailbox.h"
#include "common/image/jpeg.h"
#include "tests/data_sets/demo_room.h"
#include "tests/support/exact_picture.h"

namespace cyclorama::display {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

RgbImage smooth(int width, int height) {
  RgbImage picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      picture.at(x, y)[0] = static_cast<std::uint8_t>(127.5 + 100.0 * std::sin(x * 0.05));
      picture.at(x, y)[1] = static_cast<std::uint8_t>(127.5 + 100.0 * std::sin(y * 0.07));
      picture.at(x, y)[2] = static_cast<std::uint8_t>(200 * x / width + 20);
    }
  }
  return picture;
}

DisplayFrame frame_of(std::uint64_t order, const PictureShape& shape) {
  DisplayFrame frame;
  frame.order = order;
  frame.shape = shape;
  frame.picture =
      std::make_shared<const PlanarPicture>(JpegEncoder().to_planar(smooth(width_px(shape), height_px(shape))));
  return frame;
}

double light_of(double code) { return code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4); }
double code_of(double light) { return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1.0 / 2.4) - 0.055; }

/// Difference from double precision, in codes. The light of several pixels is averaged, as the sampler and a camera do;
/// a mean of codes would differ where a mask falls steeply.
struct Off {
  double max = 0.0;
  double mean = 0.0;
  double edge_share = 0.0;  ///< Share of pixels that cover both black and lit ones; they are not compared.
};
Off off(const HeadPlan& plan, const DisplayFrame& frame, double turn_rad, int factor) {
  const HeadSampler sampler(plan, factor);
  const RgbImage drawn = sampler.draw(frame, turn_rad);
  const ExactPicture exact(*frame.picture, frame.shape, turn_rad);
  double max = 0.0;
  double sum = 0.0;
  double count = 0.0;
  double all = 0.0;
  double edges = 0.0;
  for (int y = 0; y < drawn.height(); ++y) {
    for (int x = 0; x < drawn.width(); ++x) {
      Eigen::Vector3d wanted = Eigen::Vector3d::Zero();
      int black = 0;
      for (int k = 0; k < factor * factor; ++k) {
        const Eigen::Vector3d code = exact.code_at(plan, x * factor + k % factor, y * factor + k / factor);
        black += code.isZero() ? 1 : 0;
        wanted += factor == 1 ? code : Eigen::Vector3d(code.unaryExpr(&light_of) / (factor * factor));
      }
      all += 1.0;
      if (black > 0 && black < factor * factor) {
        edges += 1.0;
        continue;
      }
      if (factor > 1) wanted = wanted.unaryExpr(&code_of).eval();
      for (int c = 0; c < 3; ++c) {
        const double error = std::abs(255.0 * wanted[c] - drawn.at(x, y)[c]);
        max = std::max(max, error);
        sum += error;
        count += 1.0;
      }
    }
  }
  return {max, sum / count, edges / all};
}

TEST(HeadSampler, agrees_with_the_graphics_card) {
  const Installation room = demo_room_with_pixels_over(8);
  const PictureShape shape = room.picture(512);
  auto plans = planned_heads(room, shape);
  ASSERT_TRUE(plans);
  HeadPlan& middle = (*plans)[1];
  const DisplayFrame frame = frame_of(1, shape);
  for (const double turn_rad : {0.0, 0.03}) {
    const Off each = off(middle, frame, turn_rad, 1);
    EXPECT_LT(each.mean, 0.3) << "codes are rounded twice";
    EXPECT_LT(each.max, 1.5);
    const Off four = off(middle, frame, turn_rad, 2);
    EXPECT_LT(four.mean, 0.6);
    EXPECT_LT(four.max, 8.0) << "where the mask is steep";
    EXPECT_LT(four.edge_share, 0.05);
  }
  middle.colour.matrix = Eigen::Vector3d(0.9, 1.0, 0.8).asDiagonal();
  middle.colour.response = std::array<warp::ResponseCurve, 3>{
      warp::ResponseCurve::power(2.4, 64), warp::ResponseCurve::power(2.2, 64), warp::ResponseCurve::power(2.0, 64)};
  EXPECT_LT(off(middle, frame, 0.0, 1).mean, 0.8);
}

class ShownHistoryTest : public ::testing::Test {
 protected:
  ShownHistoryTest() : history_(frame_of(0, shape_), plans_) {}

  void refresh(int number, std::uint64_t first_of_frame = 0, double turn_rad = 0.0, double attract_share = 0.0,
               bool is_show = true) {
    RefreshEvent event;
    event.presented.at = at(number);
    event.is_first_of_frame = first_of_frame != 0;
    event.frame_order = first_of_frame;
    event.turn_rad = turn_rad;
    event.attract_share = attract_share;
    history_.refreshed(event, is_show);
  }
  static TimePoint at(int number) { return TimePoint{} + seconds(1000) + number * milliseconds(20); }
  ShownHistory::Shown ask(int from, int until) { return history_.between(at(from), at(until), at(until)); }

  const PictureShape shape_ = Panorama{64, 16, 1.0, 0.2, -0.2};
  const HeadPlans plans_ = std::make_shared<const std::vector<HeadPlan>>();
  ShownHistory history_;
};

TEST_F(ShownHistoryTest, has_the_moment_before_an_interval_and_those_within) {
  static_cast<void>(ask(0, 0));
  history_.frame_ready(frame_of(1, shape_));
  history_.frame_ready(frame_of(2, shape_));
  refresh(0, 1);
  for (int i = 1; i < 5; ++i) refresh(i);
  refresh(5, 2);
  refresh(6, 0, 0.01);
  refresh(7, 0, 0.01);
  const auto shown = ask(2, 7);
  ASSERT_EQ(shown.moments.size(), 3u);
  EXPECT_EQ(shown.moments[0].at, at(0));
  EXPECT_EQ(shown.moments[0].frame->order, 1u);
  EXPECT_EQ(shown.moments[1].frame->order, 2u);
  EXPECT_EQ(shown.moments[2].turn_rad, 0.01);
  EXPECT_EQ(shown.known_until, at(7));
  ASSERT_EQ(ask(6, 7).moments.size(), 1u);
}

TEST_F(ShownHistoryTest, has_no_picture_while_two_frames_are_mixed) {
  static_cast<void>(ask(0, 0));
  history_.frame_ready(frame_of(1, shape_));
  history_.frame_ready(frame_of(2, shape_));
  refresh(0, 1);
  RefreshEvent mixed;
  mixed.presented.at = at(1);
  mixed.is_first_of_frame = true;
  mixed.frame_order = 2;
  mixed.is_fading_in = true;
  history_.refreshed(mixed, true);
  refresh(2);
  const auto shown = ask(0, 2);
  ASSERT_EQ(shown.moments.size(), 3u);
  EXPECT_EQ(shown.moments[0].frame->order, 1u);
  EXPECT_EQ(shown.moments[1].frame, nullptr);
  ASSERT_NE(shown.moments[2].frame, nullptr);
  EXPECT_EQ(shown.moments[2].frame->order, 2u);
}

TEST_F(ShownHistoryTest, has_no_picture_while_no_show_is_shown) {
  static_cast<void>(ask(0, 0));
  history_.frame_ready(frame_of(1, shape_));
  refresh(0, 1);
  refresh(1, 0, 0.0, 0.0, false);
  refresh(2, 0, 0.0, 0.5);
  refresh(3, 0, 0.0, 1.0);
  const auto shown = ask(0, 3);
  ASSERT_EQ(shown.moments.size(), 3u);
  EXPECT_NE(shown.moments[0].frame, nullptr);
  EXPECT_EQ(shown.moments[1].frame, nullptr);
  ASSERT_NE(shown.moments[2].frame, nullptr);
  EXPECT_EQ(shown.moments[2].frame->order, 0u) << "its own picture";
}

TEST_F(ShownHistoryTest, has_nothing_during_a_change_of_calibrations) {
  static_cast<void>(ask(0, 0));
  history_.frame_ready(frame_of(1, shape_));
  refresh(0, 1);
  const HeadPlans next = std::make_shared<const std::vector<HeadPlan>>();
  const HeadPlans last = std::make_shared<const std::vector<HeadPlan>>();
  history_.heads_wanted(next, false);
  history_.heads_wanted(last, true);  // The one before was not used.
  refresh(1);
  history_.heads_changed();
  refresh(2);
  const auto shown = ask(0, 2);
  ASSERT_EQ(shown.moments.size(), 3u);
  EXPECT_EQ(shown.moments[1].frame, nullptr);
  EXPECT_EQ(shown.moments[2].plans, last);
  EXPECT_NE(shown.moments[2].frame, nullptr);
}

TEST_F(ShownHistoryTest, forgets_after_two_seconds_and_without_requests) {
  history_.frame_ready(frame_of(1, shape_));
  refresh(0, 1);
  for (int i = 1; i < 50; ++i) refresh(i, 0, 1e-3 * i);
  EXPECT_EQ(ask(0, 49).moments.size(), 1u) << "nobody asked before";
  for (int i = 50; i < 250; ++i) {
    refresh(i, 0, 1e-3 * i);
    if (i % 20 == 0) static_cast<void>(ask(i, i));
  }
  const auto shown = ask(0, 249);
  EXPECT_GE(shown.moments.size(), 100u);
  EXPECT_LE(shown.moments.size(), 103u);
}

}  // namespace
}  // namespace cyclorama::display
