// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/caption.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "appliance/display/presenter.h"
#include "tests/doubles/fake_clock.h"
#include "tests/support/plain_show.h"

namespace cyclorama::display {
namespace {

using testing::HasSubstr;

constexpr int kWidth = 200;
constexpr int kHeight = 200;

wire::Caption message(std::uint32_t width_px, std::uint32_t height_px, std::size_t bytes) {
  wire::Caption caption;
  caption.set_width_px(width_px);
  caption.set_height_px(height_px);
  caption.set_ink(std::string(bytes, '\xFF'));
  caption.set_width(0.4);
  caption.set_height(0.2);
  return caption;
}

std::string refused(const wire::Caption& message) {
  const auto caption = caption_of(message);
  return caption ? "accepted" : caption.error().message();
}

TEST(Caption, is_refused_unless_its_pixels_and_its_place_are_possible) {
  EXPECT_EQ(refused(message(20, 10, 200)), "accepted");
  EXPECT_EQ(refused(wire::Caption()), "accepted");
  EXPECT_THAT(refused(message(20, 10, 199)), HasSubstr("do not agree"));
  EXPECT_THAT(refused(message(5000, 1, 5000)), HasSubstr("more than 4096 x 2048"));
  wire::Caption wrong = message(20, 10, 200);
  wrong.set_width(NAN);
  EXPECT_THAT(refused(wrong), HasSubstr("size"));
  wrong = message(20, 10, 200);
  wrong.set_elevation_rad(1.6);
  EXPECT_THAT(refused(wrong), HasSubstr("direction"));
}

TEST(Caption, lies_in_the_picture_where_its_direction_is) {
  Caption caption{GreyImage(40, 20), 0.3, 0.2, 0.4, 0.2};
  const Eigen::Vector3d middle(std::sin(0.3), std::tan(0.2), -std::cos(0.3));
  for (const PictureShape& shape :
       {PictureShape(Panorama{100, 50, 3.0, 1.0, -1.0}), PictureShape(Perspective{100, 50, -1.0, 1.0, 1.0, -1.0, 0.1}),
        PictureShape(Fisheye{100, 100, 3.2, 0.6})}) {
    const auto place = place_of(shape, middle);
    ASSERT_TRUE(place);
    const bool is_dome = std::holds_alternative<Fisheye>(shape);
    const Eigen::Vector3d seen = is_dome ? Eigen::Vector3d(R_eye_picture(shape).transpose() * middle)
                                         : Eigen::Vector3d(place->across, place->up, 1.0);
    const Eigen::Vector3d at = to_caption(shape, caption) * seen;
    EXPECT_GT(at.z(), 0.0);
    EXPECT_NEAR(at.x() / at.z(), 0.5, 1e-9);
    EXPECT_NEAR(at.y() / at.z(), 0.5, 1e-9);
  }
}

/// Heads of one radian, straight ahead, on which a plate of 0.4 x 0.2 with letters on its left half is written.
class CaptionOnHeads : public testing::Test {
 protected:
  void start(const std::vector<HeadPlan>& plans, std::uint8_t code) {
    std::vector<output::HeadMode> modes;
    for (std::size_t i = 0; i < plans.size(); ++i)
      modes.push_back({std::string(1, static_cast<char>('a' + i)), kWidth, kHeight});
    presenter_.reset();
    output_.reset();  // Its context, before there is another.
    mailbox_ = std::make_unique<PresentMailbox>(plans.size());
    output_ = *output::open_headless_output({modes, 1000.0, {}, {}}, clock_);
    const AttractTimes times{std::chrono::hours(1), std::chrono::milliseconds(200)};
    auto presenter =
        Presenter::make(output_.get(), plans, *frame_of(0, plain(32, 16, 0)), times, mailbox_.get(), &clock_);
    CHECK(presenter);
    presenter_ = *std::move(presenter);
    mailbox_->frames.put(frame_of(1, plain(64, 32, code)));
    refresh(40);  // The first picture fades in.
  }
  void TearDown() override { presenter_.reset(); }
  void write(double azimuth_rad = 0.0) {
    auto caption = std::make_unique<Caption>();
    caption->ink = GreyImage(80, 40);
    for (int y = 0; y < 40; ++y) std::fill_n(caption->ink.at(0, y), 40, std::uint8_t{255});
    caption->azimuth_rad = azimuth_rad;
    caption->width = 0.4;
    caption->height = 0.2;
    mailbox_->captions.wanted.put(std::move(caption));
  }
  RefreshEvent refresh(int times) {
    RefreshEvent event;
    for (int i = 0; i < times; ++i) {
      clock_.advance(std::chrono::milliseconds(10));
      EXPECT_TRUE(presenter_->refresh());
      mailbox_->retired.clear([](const DisplayFrame&) {});
      mailbox_->captions.replaced.take();
      while (const auto popped = mailbox_->refreshes.pop()) event = *popped;
    }
    return event;
  }
  RgbImage shown(std::size_t head = 0) {
    mailbox_->heads[head].want([] { return std::make_unique<RgbImage>(kWidth, kHeight); });
    for (int i = 0; i < 5; ++i) {
      refresh(1);
      if (const auto picture = mailbox_->heads[head].take()) return *picture;
    }
    ADD_FAILURE() << "no picture";
    return RgbImage(kWidth, kHeight);
  }
  static double luminance(const RgbImage& picture, int x, int y) {
    return std::pow((picture.at(x, y)[1] / 255.0 + 0.055) / 1.055, 2.4);
  }

  FakeClock clock_;
  std::unique_ptr<PresentMailbox> mailbox_;
  std::unique_ptr<output::Output> output_;
  std::unique_ptr<Presenter> presenter_;
};

TEST_F(CaptionOnHeads, has_a_contrast_of_seven_to_one_on_any_picture) {
  for (const int code : {0, 60, 128, 200, 255}) {
    start({plain_head(kWidth, kHeight)}, static_cast<std::uint8_t>(code));
    write();
    EXPECT_TRUE(refresh(60).has_caption);
    const RgbImage picture = shown();
    // Pixels in the middle of the letters, and of the plate beside them: the plate spans pixels 60 to 140.
    const double letters = luminance(picture, 80, 100);
    const double plate = luminance(picture, 120, 100);
    EXPECT_GE((letters + 0.05) / (plate + 0.05), 7.0) << code;
    EXPECT_NEAR(picture.at(20, 100)[1], code, 1) << "beside the plate nothing changes";
    EXPECT_NEAR(picture.at(100, 50)[1], code, 1);
    presenter_.reset();
  }
}

TEST_F(CaptionOnHeads, does_not_turn_with_the_visitor) {
  start({plain_head(kWidth, kHeight)}, 128);
  write();
  refresh(60);
  const RgbImage before = shown();
  HeadingNow turned{0.15, 1, {}};
  mailbox_->headings.put(turned);
  refresh(2);
  const RgbImage after = shown();
  for (int x = 0; x < kWidth; ++x) EXPECT_NEAR(after.at(x, 100)[1], before.at(x, 100)[1], 2) << x;
}

TEST_F(CaptionOnHeads, fades_in_and_out_and_gives_its_memory_back) {
  start({plain_head(kWidth, kHeight)}, 128);
  EXPECT_FALSE(refresh(5).has_caption);
  const RgbImage before = shown();
  write();
  refresh(10);
  const int halfway = shown().at(80, 100)[1];
  refresh(60);
  EXPECT_GT(halfway, before.at(80, 100)[1]);
  EXPECT_LT(halfway, shown().at(80, 100)[1]);
  mailbox_->captions.wanted.put(std::make_unique<Caption>());
  EXPECT_FALSE(refresh(60).has_caption);
  EXPECT_EQ(shown(), before);
}

TEST_F(CaptionOnHeads, is_blended_where_two_projectors_overlap) {
  // Two heads show the same place with a third and two thirds of the light.
  HeadPlan third = plain_head(kWidth, kHeight);
  third.mask = warp::MaskImage(kWidth, kHeight, 1.0f / 3.0f);
  HeadPlan rest = third;
  rest.mask = warp::MaskImage(kWidth, kHeight, 2.0f / 3.0f);
  start({third, rest}, 200);
  write();
  refresh(60);
  const RgbImage a = shown(0);
  const RgbImage b = shown(1);
  EXPECT_NEAR(luminance(a, 80, 100) + luminance(b, 80, 100), kInkLight, 0.02);
  EXPECT_NEAR(luminance(a, 120, 100) + luminance(b, 120, 100),
              kPlateLeaves * std::pow((200 / 255.0 + 0.055) / 1.055, 2.4), 0.01);
}

TEST_F(CaptionOnHeads, is_not_drawn_on_heads_beside_it) {
  start({plain_head(kWidth, kHeight)}, 128);
  const RgbImage before = shown();
  write(2.0);
  refresh(60);
  EXPECT_EQ(shown(), before);
}

TEST_F(CaptionOnHeads, survives_the_loss_of_an_output) {
  start({plain_head(kWidth, kHeight)}, 128);
  write();
  refresh(60);
  PresenterState state = presenter_->take_state();
  const HeadPlans plans = state.plans;
  presenter_.reset();
  auto next = Presenter::make(output_.get(), plans, false, *frame_of(0, plain(32, 16, 0)), {}, mailbox_.get(), &clock_);
  ASSERT_TRUE(next);
  presenter_ = *std::move(next);
  ASSERT_TRUE(presenter_->go_on_with(std::move(state)));
  EXPECT_TRUE(refresh(60).has_caption);
}

}  // namespace
}  // namespace cyclorama::display
