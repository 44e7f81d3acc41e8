// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/session/outbox.h"

#include <gtest/gtest.h>

#include <random>
#include <string>

namespace cyclorama::tour {
namespace {

SharedShowMessage begin(std::uint64_t number) {
  auto message = std::make_shared<wire::ShowMessage>();
  message->mutable_begin()->set_number(number);
  return message;
}
SharedShowMessage tile(std::uint64_t number, std::size_t bytes = 100) {
  auto message = std::make_shared<wire::ShowMessage>();
  message->mutable_tile()->set_view_number(number);
  message->mutable_tile()->set_jpeg(std::string(bytes, 'j'));
  return message;
}
SharedShowMessage end(std::uint64_t number) {
  auto message = std::make_shared<wire::ShowMessage>();
  message->mutable_end()->set_view_number(number);
  message->mutable_end()->set_complete(true);
  return message;
}
wire::Heading heading(double heading_rad, std::int64_t shutter_ns) {
  wire::Heading heading;
  heading.set_heading_rad(heading_rad);
  heading.set_shutter_ns(shutter_ns);
  heading.mutable_eye_m()->set_z(2.0 * heading_rad);
  return heading;
}
Outbox introduced(std::size_t max_bytes = 1000) {
  Outbox outbox(wire::Panorama(), max_bytes);
  outbox.put_heading(heading(0.0, 0));
  EXPECT_TRUE(outbox.take()->has_heading());
  return outbox;
}

TEST(Outbox, sends_nothing_before_the_first_heading_which_states_what_is_shown) {
  wire::Panorama shown;
  shown.set_width_px(77);
  Outbox outbox(shown);
  outbox.put(begin(1));
  EXPECT_EQ(outbox.take(), nullptr);
  outbox.put_heading(heading(0.5, 9));
  outbox.put_heading(heading(0.6, 10));
  const auto first = outbox.take();
  EXPECT_EQ(first->heading().heading_rad(), 0.6) << "the newest wins";
  EXPECT_EQ(first->heading().eye_m().z(), 1.2);
  EXPECT_EQ(first->heading().shown().width_px(), 77u);
  outbox.put_heading(heading(0.7, 11));
  EXPECT_FALSE(outbox.take()->heading().has_shown());
}

TEST(Outbox, lets_a_heading_overtake_tiles) {
  Outbox outbox = introduced();
  outbox.put(begin(1));
  outbox.put(tile(1));
  outbox.put_heading(heading(0.1, 0));
  EXPECT_TRUE(outbox.take()->has_heading());
  EXPECT_TRUE(outbox.take()->has_begin());
  EXPECT_TRUE(outbox.take()->has_tile());
}

TEST(Outbox, sends_the_presentation_time_of_a_heading) {
  Outbox outbox = introduced();
  wire::ShowAt at;
  at.set_refresh(77);
  outbox.put_heading(heading(0.1, 0), &at);
  EXPECT_EQ(outbox.take()->show_at().refresh(), 77);
  outbox.put_heading(heading(0.2, 0));
  EXPECT_FALSE(outbox.take()->has_show_at());
}

TEST(Outbox, keeps_the_newest_answer_until_it_can_be_sent) {
  Outbox outbox = introduced();
  EXPECT_FALSE(outbox.take_answer());
  wire::ClockReply answer;
  answer.set_asked_ns(1);
  outbox.put_answer(answer);
  answer.set_asked_ns(2);
  outbox.put_answer(answer);
  outbox.put(begin(1));
  EXPECT_TRUE(outbox.take()->has_begin()) << "it is taken by itself";
  EXPECT_EQ(outbox.take_answer()->asked_ns(), 2);
  EXPECT_FALSE(outbox.take_answer());
}

TEST(Outbox, drops_a_waiting_frame_for_the_next_one) {
  Outbox outbox = introduced();
  for (const auto& message : {begin(1), tile(1), end(1)}) EXPECT_FALSE(outbox.put(message));
  EXPECT_EQ(outbox.put(begin(2)), 1u);
  EXPECT_EQ(outbox.take()->begin().number(), 2u);
  EXPECT_EQ(outbox.waiting_bytes(), 0u);
}

TEST(Outbox, finishes_the_frame_that_is_being_sent) {
  Outbox outbox = introduced();
  for (const auto& message : {begin(1), tile(1), tile(1), end(1)}) outbox.put(message);
  EXPECT_TRUE(outbox.take()->has_begin());
  EXPECT_FALSE(outbox.put(begin(2)));
  EXPECT_EQ(outbox.put(begin(3)), 2u);
  EXPECT_EQ(outbox.take()->tile().view_number(), 1u);
  EXPECT_EQ(outbox.take()->tile().view_number(), 1u);
  EXPECT_EQ(outbox.take()->end().view_number(), 1u);
  EXPECT_EQ(outbox.take()->begin().number(), 3u);
}

TEST(Outbox, starts_a_late_display_with_the_next_frame) {
  Outbox outbox = introduced();
  outbox.put(tile(1));
  outbox.put(end(1));
  EXPECT_EQ(outbox.take(), nullptr);
  outbox.put(begin(2));
  EXPECT_EQ(outbox.take()->begin().number(), 2u);
}

TEST(Outbox, ends_a_frame_over_the_limit_as_incomplete) {
  Outbox outbox = introduced(250);
  outbox.put(begin(1));
  EXPECT_TRUE(outbox.take()->has_begin());
  outbox.put(tile(1));
  outbox.put(tile(1));
  EXPECT_EQ(outbox.put(tile(1)), 1u);
  EXPECT_FALSE(outbox.put(tile(1)));
  EXPECT_FALSE(outbox.put(end(1)));
  const auto last = outbox.take();
  ASSERT_TRUE(last->has_end());
  EXPECT_FALSE(last->end().complete());
  EXPECT_EQ(last->end().view_number(), 1u);
  EXPECT_EQ(outbox.take(), nullptr);
}

TEST(Outbox, names_a_frame_over_the_limit_even_after_all_its_tiles_were_sent) {
  Outbox outbox = introduced(250);
  outbox.put(begin(7));
  EXPECT_TRUE(outbox.take()->has_begin());
  EXPECT_EQ(outbox.put(tile(7, 300)), 7u);
  EXPECT_EQ(outbox.take()->end().view_number(), 7u);
}

TEST(Outbox, drops_a_frame_over_the_limit_that_was_not_begun) {
  Outbox outbox = introduced(250);
  outbox.put(begin(1));
  outbox.put(tile(1));
  outbox.put(tile(1));
  EXPECT_EQ(outbox.put(tile(1)), 1u);
  EXPECT_EQ(outbox.take(), nullptr);
}

TEST(Outbox, keeps_its_guarantees_for_any_order_of_calls) {
  std::mt19937 random(5);
  Outbox outbox = introduced(600);
  std::uint64_t number = 0;
  std::uint64_t open = 0;
  int tiles_left = 0;
  for (int i = 0; i < 50'000; ++i) {
    const auto dice = random() % 10;
    if (dice < 4) {
      if (tiles_left == 0 && number > 0) outbox.put(end(number));
      if (tiles_left-- <= 0) {
        outbox.put(begin(++number));
        tiles_left = static_cast<int>(random() % 6);
      } else {
        outbox.put(tile(number, random() % 300));
      }
    } else if (dice == 4) {
      outbox.put_heading(heading(1.0, 0));
    } else if (const auto message = outbox.take()) {
      if (message->has_begin()) {
        ASSERT_EQ(open, 0u);
        open = message->begin().number();
      } else if (message->has_tile()) {
        ASSERT_EQ(message->tile().view_number(), open);
      } else if (message->has_end()) {
        ASSERT_EQ(message->end().view_number(), open);
        open = 0;
      }
    }
    ASSERT_LE(outbox.waiting_bytes(), 600u);
  }
  EXPECT_GT(number, 1000u);
}

}  // namespace
}  // namespace cyclorama::tour
