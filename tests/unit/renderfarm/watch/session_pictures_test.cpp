// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/watch/session_pictures.h"

#include <gtest/gtest.h>

#include <thread>

#include "renderfarm/watch/mjpeg.h"
#include "tests/data_sets/jpeg_tiles.h"
#include "tests/doubles/fake_process.h"

namespace cyclorama::watch {
namespace {

using namespace std::chrono_literals;

/// A session whose museum receives every message at once.
struct Session {
  SessionPictures pictures;
  Panorama panorama{};
  std::uint64_t number = 0;

  Session() {
    wire::SessionReply reply;
    reply.mutable_opened()->set_name("grotto");
    pictures.taken(1, std::move(reply));
  }
  void begin(int width, int height) {
    wire::SessionReply reply;
    reply.mutable_begin()->mutable_panorama()->set_width_px(static_cast<std::uint32_t>(width));
    reply.mutable_begin()->mutable_panorama()->set_height_px(static_cast<std::uint32_t>(height));
    pictures.taken(1, std::move(reply));
  }
  void tile(wire::Tile tile) {
    wire::SessionReply reply;
    *reply.mutable_tile() = std::move(tile);
    pictures.taken(1, std::move(reply));
  }
  void end(bool complete) {
    wire::SessionReply reply;
    *reply.mutable_end() = end_of(++number, 1, complete);
    pictures.taken(1, std::move(reply));
  }
  void frame(const RgbImage& picture, bool complete = true) {
    begin(picture.width(), picture.height());
    for (wire::Tile& part : tiles_of(number, picture)) tile(std::move(part));
    end(complete);
  }
  std::shared_ptr<const FramePicture> now(std::uint64_t after = 0) { return pictures.newest(1, after, TimePoint{}); }
};

int max_difference(const RgbImage& a, const RgbImage& b) {
  int max = 0;
  for (std::size_t i = 0; i < a.data().size(); ++i) max = std::max(max, std::abs(a.data()[i] - b.data()[i]));
  return max;
}

TEST(SessionPictures, assembles_the_newest_complete_frame_from_its_tiles) {
  Session session;
  EXPECT_TRUE(session.pictures.is_open(1));
  EXPECT_EQ(session.now(), nullptr);
  const auto ramp = ramp_picture(3, 200, 100);
  session.frame(*ramp);
  const auto frame = session.now();
  ASSERT_NE(frame, nullptr);
  const auto picture = composed(*frame);
  ASSERT_TRUE(picture) << picture.error().message();
  ASSERT_EQ(picture->width(), 200);
  EXPECT_LE(max_difference(*picture, *ramp), 12);  // JPEG of quality 95.
  session.frame(*ramp_picture(9));
  EXPECT_EQ(session.now()->width_px, 64);
  EXPECT_EQ(session.now(session.now()->serial), nullptr) << "nothing newer";
}

TEST(SessionPictures, keeps_no_depth) {
  Session session;
  session.begin(64, 64);
  for (wire::Tile& part : tiles_of(0, RgbImage(64, 64))) {
    part.set_depth("depth");
    session.tile(std::move(part));
  }
  session.end(true);
  ASSERT_NE(session.now(), nullptr);
  ASSERT_FALSE(session.now()->tiles.empty());
  for (const wire::Tile& tile : session.now()->tiles) EXPECT_TRUE(tile.depth().empty());
}

TEST(SessionPictures, never_shows_an_abandoned_frame) {
  Session session;
  session.frame(*ramp_picture(0, 96, 48), false);
  EXPECT_EQ(session.now(), nullptr);
  session.begin(64, 32);
  session.frame(*ramp_picture(1), true);
  EXPECT_EQ(session.now()->tiles.size(), 1u) << "a begin throws away what was there";
}

TEST(SessionPictures, a_frame_over_the_limit_is_left_out) {
  Session session;
  session.begin(64, 32);
  wire::Tile large;
  large.set_jpeg(std::string(SessionPictures::kMaxBytes / 2 + 1, 'x'));
  session.tile(large);
  session.tile(large);
  session.tile(large);
  session.end(true);
  EXPECT_EQ(session.now(), nullptr);
  session.frame(*ramp_picture(0));
  EXPECT_NE(session.now(), nullptr);
}

TEST(SessionPictures, tiles_that_do_not_fit_are_an_error) {
  for (const auto& [x, width] :
       {std::pair{1u, 64u}, {64u, 1u}, {0u, 65u}, {0xffffffffu, 64u}, {0u, 0u}, {0u, 0xffffffffu}}) {
    FramePicture frame{1, 64, 32, {}};
    wire::Tile tile = tiles_of(1, *ramp_picture(0)).front();
    tile.set_x_px(x);
    tile.set_width_px(width);
    frame.tiles.push_back(tile);
    const auto picture = composed(frame);
    ASSERT_FALSE(picture) << x << ' ' << width;
    EXPECT_EQ(picture.error().code(), ErrorCode::kBadData);
  }
}

TEST(SessionPictures, waiting_ends_with_a_picture_or_the_session) {
  Session session;
  std::thread loop([&] { session.frame(*ramp_picture(0)); });
  EXPECT_NE(session.pictures.newest(1, 0, SteadyClock().now() + 20s), nullptr);
  loop.join();
  const std::uint64_t last = session.now()->serial;
  std::thread end([&] { session.pictures.session_ended(1); });
  EXPECT_EQ(session.pictures.newest(1, last, SteadyClock().now() + 20s), nullptr);
  end.join();
  EXPECT_FALSE(session.pictures.is_open(1));
  Session other;
  other.pictures.close();
  EXPECT_FALSE(other.pictures.is_open(1));
}

TEST(Halved, each_pixel_is_the_mean_of_four) {
  RgbImage image(5, 3, 10);
  image.at(2, 0)[1] = 250;
  const RgbImage half = halved(image);
  ASSERT_EQ(half.width(), 2);
  ASSERT_EQ(half.height(), 1);
  EXPECT_EQ(half.at(0, 0)[1], 10);
  EXPECT_EQ(half.at(1, 0)[1], 70);
  EXPECT_EQ(half.at(1, 0)[0], 10);
  EXPECT_EQ(halved(RgbImage(1, 3, 10)).height(), 3);
}

TEST(Mjpeg, each_part_carries_its_length_and_ends_with_the_boundary) {
  const std::vector<std::byte> jpeg{std::byte{0xff}, std::byte{0xd8}, std::byte{'\r'}, std::byte{0}};
  EXPECT_EQ(mjpeg_begin() + mjpeg_part(jpeg) + mjpeg_part({}),
            std::string("--cyclorama-picture\r\n"
                        "Content-Type: image/jpeg\r\nContent-Length: 4\r\n\r\n\xff\xd8\r\0\r\n"
                        "--cyclorama-picture\r\n"
                        "Content-Type: image/jpeg\r\nContent-Length: 0\r\n\r\n\r\n"
                        "--cyclorama-picture\r\n",
                        165));
  EXPECT_NE(std::string(kMjpegType).find("boundary=cyclorama-picture"), std::string::npos);
}

}  // namespace
}  // namespace cyclorama::watch
