// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/frame_assembler.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <condition_variable>
#include <future>
#include <limits>
#include <mutex>

#include "common/base/file.h"
#include "tests/data_sets/heads_that_see_all.h"
#include "tests/data_sets/jpeg_tiles.h"
#include "tests/data_sets/shared_data.h"

namespace cyclorama::display {
namespace {

using Messages = std::vector<wire::ShowMessage>;
using ::testing::HasSubstr;

const Panorama kPanorama{150, 90, 2.0, 0.5, -0.5};  // The sides are no multiples of 16.

RgbImage gradient(int width = kPanorama.width_px, int height = kPanorama.height_px) {
  RgbImage picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      picture.at(x, y)[0] = static_cast<std::uint8_t>(255 * x / width);
      picture.at(x, y)[1] = static_cast<std::uint8_t>(255 * y / height);
      picture.at(x, y)[2] = 90;
    }
  }
  return picture;
}

int max_difference(const PlanarPicture& planes, const RgbImage& b) {
  const RgbImage a = JpegDecoder().to_rgb(planes);
  if (a.width() != b.width() || a.height() != b.height()) return 256;
  int largest = 0;
  for (std::size_t i = 0; i < a.data().size(); ++i)
    largest = std::max(largest, std::abs(int{a.data()[i]} - int{b.data()[i]}));
  return largest;
}

/// Records all output, and lets the test wait for it.
class RecordingSink final : public FrameSink {
 public:
  void frame_ready(DisplayFrame frame) override {
    const std::lock_guard lock(mutex_);
    frames.push_back(std::move(frame));
    changed_.notify_all();
  }
  void frame_dropped(std::uint64_t number, const std::string& reason) override {
    const std::lock_guard lock(mutex_);
    drops.emplace_back(number, reason);
    changed_.notify_all();
  }
  bool wait_for(std::size_t outcomes) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(20), [&] { return frames.size() + drops.size() >= outcomes; });
  }
  std::vector<DisplayFrame> frames;
  std::vector<std::pair<std::uint64_t, std::string>> drops;

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
};

class FrameAssemblerTest : public ::testing::Test {
 protected:
  void send(const Messages& messages) {
    for (const wire::ShowMessage& message : messages) assembler_.take(message);
  }
  Messages good(std::uint64_t number) { return frame_messages(number, gradient(), kPanorama, 0.25); }

  /// Sends `bad`, then a good frame: the first must be dropped for `reason` and the second shown.
  void expect_dropped(const Messages& bad, const std::string& reason, std::uint64_t number = 7) {
    send(bad);
    send(good(8));
    ASSERT_TRUE(sink_.wait_for(2));
    ASSERT_THAT(sink_.drops, ::testing::SizeIs(1));
    EXPECT_EQ(sink_.drops[0].first, number);
    EXPECT_THAT(sink_.drops[0].second, HasSubstr(reason));
    ASSERT_EQ(sink_.frames.size(), 1U);
    EXPECT_EQ(sink_.frames[0].number, 8U);
    EXPECT_LE(max_difference(*sink_.frames[0].picture, gradient()), 12);
  }

  SteadyClock clock_;
  RecordingSink sink_;
  DecodePool pool_{2};
  FrameAssembler assembler_{&pool_, &sink_, &clock_, heads_that_see_all()};
};

TEST_F(FrameAssemblerTest, returns_a_complete_frame_as_it_was_sent) {
  Messages messages = good(7);
  messages[0].mutable_begin()->set_shutter_ns(123456);
  send(messages);
  ASSERT_TRUE(sink_.wait_for(1));
  ASSERT_EQ(sink_.frames.size(), 1U);
  const DisplayFrame& frame = sink_.frames[0];
  EXPECT_EQ(frame.number, 7U);
  EXPECT_EQ(frame.order, 1U);
  EXPECT_EQ(frame.heading_rad, 0.25);
  EXPECT_EQ(frame.shutter_ns, 123456);
  EXPECT_EQ(frame.shape, PictureShape(kPanorama));
  EXPECT_LE(max_difference(*frame.picture, gradient()), 12);
  EXPECT_GT(frame.bytes, 1000U);
  EXPECT_GE(frame.decoded_at, frame.begun_at);
}

/// The frame of good(), with depth in every tile.
Messages with_depth(Messages messages, float distance_m) {
  for (wire::ShowMessage& message : messages) {
    if (message.has_begin()) message.mutable_begin()->set_depth(true);
    if (!message.has_tile()) continue;
    wire::Tile* const tile = message.mutable_tile();
    const PixelRect cells =
        depth_cells({0, 0, static_cast<int>(tile->width_px()), static_cast<int>(tile->height_px())});
    tile->set_depth(encode_inverse_depth(InverseDepthImage(cells.width, cells.height, inverse_depth_of(distance_m))));
  }
  return messages;
}

float inverse_metres_of(const DisplayFrame& frame) {
  ReprojectedPicture moved;
  frame.mesh->move(Eigen::Vector3d::Zero(), &moved);
  return moved.vertices[moved.vertices.size() / 2].inverse_m;
}

TEST_F(FrameAssemblerTest, makes_a_mesh_of_the_tiles_depth) {
  Messages messages = with_depth(good(7), 2.0f);
  messages[0].mutable_begin()->mutable_eye_m()->set_y(1.5);
  send(messages);
  send(good(8));
  ASSERT_TRUE(sink_.wait_for(2));
  ASSERT_EQ(sink_.frames.size(), 2U);
  ASSERT_NE(sink_.frames[0].mesh, nullptr);
  EXPECT_EQ(sink_.frames[0].eye_m, Eigen::Vector3d(0, 1.5, 0));
  EXPECT_NEAR(inverse_metres_of(sink_.frames[0]), 0.5f, 0.002f);
  EXPECT_EQ(sink_.frames[1].mesh, nullptr);  // Its view did not ask for depth.
  EXPECT_EQ(sink_.frames[1].depth_trouble, "");
}

TEST_F(FrameAssemblerTest, shows_a_frame_without_its_depth_if_that_is_missing_or_damaged) {
  Messages missing = with_depth(good(7), 2.0f);
  missing[3].mutable_tile()->clear_depth();
  Messages damaged = with_depth(good(8), 2.0f);
  damaged[2].mutable_tile()->mutable_depth()->back() ^= 0x55;
  damaged[2].mutable_tile()->mutable_depth()->resize(damaged[2].tile().depth().size() / 2);
  Messages foreign = with_depth(good(9), 2.0f);
  foreign[1].mutable_tile()->set_depth(encode_inverse_depth(InverseDepthImage(3, 1)));
  for (const Messages& messages : {missing, damaged, foreign}) send(messages);
  ASSERT_TRUE(sink_.wait_for(3));
  ASSERT_EQ(sink_.frames.size(), 3U);
  std::ranges::sort(sink_.frames, {}, &DisplayFrame::number);
  for (const DisplayFrame& frame : sink_.frames) {
    EXPECT_EQ(frame.mesh, nullptr);
    EXPECT_LE(max_difference(*frame.picture, gradient()), 12);
  }
  EXPECT_THAT(sink_.frames[0].depth_trouble, HasSubstr("the depth is missing"));
  EXPECT_THAT(sink_.frames[1].depth_trouble, HasSubstr("the depth is damaged"));
  EXPECT_THAT(sink_.frames[2].depth_trouble, HasSubstr("another size"));
}

TEST_F(FrameAssemblerTest, shares_depth_with_a_finer_picture_of_the_same_view_only) {
  send(with_depth(good(7), 2.0f));
  ASSERT_TRUE(sink_.wait_for(1));
  const Panorama finer{300, 180, 2.0, 0.5, -0.5};
  send(frame_messages(7, gradient(300, 180), finer, 0.25));
  ASSERT_TRUE(sink_.wait_for(2));
  send(good(8));
  ASSERT_TRUE(sink_.wait_for(3));
  ASSERT_EQ(sink_.frames.size(), 3U);
  ASSERT_NE(sink_.frames[1].mesh, nullptr);
  EXPECT_EQ(sink_.frames[1].mesh->grid().picture.width_px(), 300);
  EXPECT_NEAR(inverse_metres_of(sink_.frames[1]), 0.5f, 0.002f);
  EXPECT_EQ(sink_.frames[2].mesh, nullptr);
}

TEST_F(FrameAssemblerTest, forgets_depth_with_the_connection) {
  send(with_depth(good(7), 2.0f));
  ASSERT_TRUE(sink_.wait_for(1));
  assembler_.stream_lost();
  send(good(7));  // Another session counts from the start again.
  ASSERT_TRUE(sink_.wait_for(2));
  EXPECT_EQ(sink_.frames[1].mesh, nullptr);
}

TEST_F(FrameAssemblerTest, accepts_tiles_in_any_order_and_of_any_size) {
  Messages messages = good(7);
  std::reverse(messages.begin() + 1, messages.end() - 1);
  send(messages);
  send(frame_messages(8, gradient(), kPanorama, 0.0, 16));
  send(frame_messages(9, gradient(), kPanorama, 0.0, 1024));
  ASSERT_TRUE(sink_.wait_for(3));
  ASSERT_EQ(sink_.frames.size(), 3U);
  for (const DisplayFrame& frame : sink_.frames) EXPECT_LE(max_difference(*frame.picture, gradient()), 12);
}

TEST_F(FrameAssemblerTest, accepts_half_chroma_and_drops_a_frame_that_changes_it) {
  Messages messages = good(7);
  Messages halved = messages;
  const RgbImage grey(kPanorama.width_px, kPanorama.height_px, 77);
  for (std::size_t i = 1; i + 1 < messages.size(); ++i) {
    wire::Tile* const tile = halved[i].mutable_tile();
    const auto jpeg = JpegEncoder().encode(grey.at(0, 0), static_cast<int>(tile->width_px()),
                                           static_cast<int>(tile->height_px()), grey.row_values(), {95, true});
    ASSERT_TRUE(jpeg);
    tile->set_jpeg(jpeg->data(), jpeg->size());
  }
  send(halved);
  ASSERT_TRUE(sink_.wait_for(1));
  ASSERT_EQ(sink_.frames.size(), 1U);
  EXPECT_TRUE(sink_.frames[0].picture->has_half_chroma());
  EXPECT_LE(max_difference(*sink_.frames[0].picture, grey), 2);
  sink_.frames.clear();
  messages[3] = halved[3];
  expect_dropped(messages, "colours are not kept as 4:4:4");
}

TEST(FrameAssembler, decodes_only_the_tiles_that_a_head_shows) {
  SteadyClock clock;
  RecordingSink sink;
  DecodePool pool(1);
  // A head that shows 0.2 of the wall's 1.6 rad, in a picture of 2 rad, which may be turned by 0.2 either way.
  warp::PixelMap map(3, 200);
  for (int y = 0; y < 200; ++y) {
    for (int x = 0; x < 3; ++x) {
      map.at(x, y)[0] = -0.1f + 0.1f * static_cast<float>(x);
      map.at(x, y)[1] = 0.5f - static_cast<float>(y) / 200.0f;
    }
  }
  FrameAssembler assembler(&pool, &sink, &clock,
                           {{HeadFootprint(map, warp::MaskImage(3, 200, 1.0f))}, Panorama{1280, 96, 1.6, 0.5, -0.5}});
  const Panorama panorama{1600, 96, 2.0, 0.5, -0.5};
  const RgbImage picture = gradient(1600, 96);
  for (const auto& message : frame_messages(7, picture, panorama, 0.0, 32)) assembler.take(message);
  ASSERT_TRUE(sink.wait_for(1));
  ASSERT_EQ(sink.frames.size(), 1U);
  const DisplayFrame& frame = sink.frames[0];
  EXPECT_EQ(frame.tiles, 50U * 3U);
  EXPECT_NEAR(frame.turn_limit_rad, 0.2, 1e-9);
  // 0.6 rad are 480 px, and 3 for the filters on either side: from 557 to 1043.
  EXPECT_EQ(frame.decoded, 16U * 3U);
  const RgbImage shown = JpegDecoder().to_rgb(*frame.picture);
  ASSERT_TRUE(frame.parts != nullptr);
  ASSERT_EQ(frame.parts->size(), 1U);
  const PixelRect part = frame.parts->front();
  EXPECT_LE(part.x, 800 - 240 - 3);
  EXPECT_GE(part.x + part.width, 800 + 240 + 3);
  EXPECT_EQ(part.height, 96);
  for (int y = 0; y < 96; ++y) {
    for (int x = part.x; x < part.x + part.width; ++x) ASSERT_NEAR(shown.at(x, y)[0], picture.at(x, y)[0], 12);
  }
}

TEST_F(FrameAssemblerTest, keeps_frames_apart_that_are_held_for_a_long_time) {
  std::vector<RgbImage> sent;
  for (std::uint64_t n = 1; n <= 8; ++n) {
    sent.emplace_back(kPanorama.width_px, kPanorama.height_px, static_cast<std::uint8_t>(20 * n));
    send(frame_messages(n, sent.back(), kPanorama));
    ASSERT_TRUE(sink_.wait_for(n));
  }
  ASSERT_EQ(sink_.frames.size(), 8U);
  for (std::size_t i = 0; i < 8; ++i) EXPECT_LE(max_difference(*sink_.frames[i].picture, sent[i]), 3);
  sink_.frames.clear();  // Their pictures are reused, with other sizes in between.
  const Panorama other{64, 64, 1.0, 0.5, -0.5};
  send(frame_messages(9, gradient(64, 64), other));
  ASSERT_TRUE(sink_.wait_for(1));
  send(good(10));
  ASSERT_TRUE(sink_.wait_for(2));
  EXPECT_LE(max_difference(*sink_.frames[0].picture, gradient(64, 64)), 12);
  EXPECT_LE(max_difference(*sink_.frames[1].picture, gradient()), 12);
}

TEST_F(FrameAssemblerTest, drops_a_frame_whose_tile_is_missing) {
  Messages messages = good(7);
  messages.erase(messages.begin() + 2);
  expect_dropped(messages, "5 of 6 tiles came");
}

TEST_F(FrameAssemblerTest, drops_a_frame_with_a_hole_that_its_end_calls_complete) {
  Messages messages = good(7);
  messages.erase(messages.begin() + 2);
  messages.back().mutable_end()->set_tiles(5);
  expect_dropped(messages, "cells of the picture are empty");
}

TEST_F(FrameAssemblerTest, drops_a_frame_with_a_duplicate_tile) {
  Messages messages = good(7);
  messages.insert(messages.begin() + 2, messages[1]);
  expect_dropped(messages, "covers a place that another tile covers");
}

TEST_F(FrameAssemblerTest, drops_a_frame_with_a_tile_of_another_frame) {
  Messages messages = good(7);
  messages[2].mutable_tile()->set_view_number(6);
  expect_dropped(messages, "a tile of frame 6");
}

TEST_F(FrameAssemblerTest, drops_a_frame_with_a_tile_outside_it) {
  for (const auto& [x, width] :
       {std::pair<std::uint32_t, std::uint32_t>{144, 64}, {5, 16}, {0, 0}, {0xfffffff0U, 32}, {16, 0xffffffffU}}) {
    sink_.drops.clear();
    sink_.frames.clear();
    Messages messages = good(7);
    messages[1].mutable_tile()->set_x_px(x);
    messages[1].mutable_tile()->set_width_px(width);
    expect_dropped(messages, "does not fit");
  }
}

TEST_F(FrameAssemblerTest, drops_a_frame_with_a_tile_that_ends_off_the_grid) {
  Messages messages = good(7);
  messages[1].mutable_tile()->set_width_px(40);
  expect_dropped(messages, "does not end on a cut");
}

TEST_F(FrameAssemblerTest, drops_a_frame_with_a_tile_of_a_wrong_size) {
  Messages messages = good(7);
  *messages[1].mutable_tile()->mutable_jpeg() = messages[3].tile().jpeg();  // The narrower tile at the right edge.
  expect_dropped(messages, "were announced");
}

TEST_F(FrameAssemblerTest, drops_a_frame_with_a_damaged_or_empty_tile) {
  for (const int damage : {0, 1, 2}) {
    sink_.drops.clear();
    sink_.frames.clear();
    Messages messages = good(7);
    std::string* const jpeg = messages[4].mutable_tile()->mutable_jpeg();
    if (damage == 0) jpeg->clear();
    if (damage == 1) jpeg->resize(jpeg->size() / 2);
    if (damage == 2) jpeg->replace(0, 4, "\x89PNG");
    expect_dropped(messages, "JPEG");
  }
}

TEST_F(FrameAssemblerTest, drops_a_frame_that_the_farm_gave_up_with_its_reason) {
  Messages messages = good(7);
  messages.back().mutable_end()->set_complete(false);
  messages.back().mutable_end()->set_reason("node 2 was lost\x1b[31m");
  messages.erase(messages.begin() + 3, messages.end() - 1);
  expect_dropped(messages, "the farm gave the frame up: node 2 was lost?[31m");
}

TEST_F(FrameAssemblerTest, drops_a_frame_that_another_interrupts) {
  Messages messages = good(7);
  messages.pop_back();
  expect_dropped(messages, "another frame began");
}

TEST_F(FrameAssemblerTest, drops_a_frame_with_the_end_of_another_frame) {
  Messages messages = good(7);
  messages.back().mutable_end()->set_view_number(6);
  expect_dropped(messages, "the end of frame 6");
}

TEST_F(FrameAssemblerTest, drops_invalid_views) {
  const auto refused = [&](const auto& change, const std::string& reason, std::uint64_t number = 7) {
    sink_.drops.clear();
    sink_.frames.clear();
    Messages messages = good(7);
    change(messages[0].mutable_begin());
    if (number != 7) {
      for (std::size_t i = 1; i + 1 < messages.size(); ++i) messages[i].mutable_tile()->set_view_number(number);
      messages.back().mutable_end()->set_view_number(number);
    }
    expect_dropped(messages, reason, number);
  };
  refused([](wire::View* v) { v->set_number(0); }, "number", 0);
  refused([](wire::View* v) { v->set_heading_rad(std::numeric_limits<double>::quiet_NaN()); }, "heading_rad");
  refused([](wire::View* v) { v->mutable_panorama()->set_width_px(0); }, "width_px");
  refused([](wire::View* v) { v->mutable_panorama()->set_width_px(0xffffffffU); }, "width_px");
  refused([](wire::View* v) { v->mutable_panorama()->set_azimuth_span_rad(7.0); }, "azimuth_span_rad");
  refused([](wire::View* v) { v->mutable_panorama()->set_tan_elevation_top(-1.0); }, "tan_elevation_top");
  refused([](wire::View* v) { v->clear_panorama(); }, "width_px");
  refused(
      [](wire::View* v) {
        to_wire(Fisheye{kPanorama.width_px, kPanorama.height_px}, v->mutable_panorama());
      },
      "another kind than this wall's");
  refused(
      [](wire::View* v) {
        v->mutable_panorama()->set_width_px(16384);
        v->mutable_panorama()->set_height_px(16384);
      },
      "16384x16384 pixels");
}

TEST_F(FrameAssemblerTest, drops_tiles_and_ends_without_a_begin_and_reports_it_once) {
  Messages messages = good(7);
  messages.erase(messages.begin());
  expect_dropped(messages, "without its frame's begin");
  sink_.drops.clear();
  sink_.frames.clear();
  expect_dropped({good(7).back()}, "its end came without its begin");
}

TEST_F(FrameAssemblerTest, drops_the_unfinished_frame_of_a_lost_stream) {
  Messages messages = good(7);
  messages.resize(3);
  send(messages);
  assembler_.stream_lost();
  send(good(8));
  ASSERT_TRUE(sink_.wait_for(2));
  ASSERT_EQ(sink_.drops.size(), 1U);
  EXPECT_THAT(sink_.drops[0].second, HasSubstr("connection"));
  EXPECT_EQ(sink_.frames.size(), 1U);
}

TEST_F(FrameAssemblerTest, drops_frames_that_arrive_faster_than_they_are_decoded) {
  std::promise<void> gate;
  const auto opened = gate.get_future().share();
  for (int thread = 0; thread < 2; ++thread) {
    pool_.submit([opened](JpegDecoder&) { opened.wait_for(std::chrono::seconds(20)); });
  }
  for (std::uint64_t n = 1; n <= 5; ++n) send(good(n));
  ASSERT_TRUE(sink_.wait_for(2));
  EXPECT_THAT(sink_.drops[0].second, HasSubstr("faster than this display decodes"));
  EXPECT_EQ(sink_.drops[0].first, 4U);
  gate.set_value();
  ASSERT_TRUE(sink_.wait_for(5));
  EXPECT_EQ(sink_.frames.size(), 3U);
}

TEST(FrameAssembler, never_shows_a_frame_with_undecoded_tiles_when_the_display_stops) {
  SteadyClock clock;
  RecordingSink sink;
  std::promise<void> gate;
  {
    auto pool = std::make_unique<DecodePool>(1);
    std::promise<void> begun;
    pool->submit([&, opened = gate.get_future().share()](JpegDecoder&) {
      begun.set_value();
      opened.wait_for(std::chrono::seconds(20));
    });
    begun.get_future().wait_for(std::chrono::seconds(20));
    FrameAssembler assembler(pool.get(), &sink, &clock, heads_that_see_all());
    for (const auto& message : frame_messages(7, gradient(), kPanorama)) assembler.take(message);
    std::jthread opener([&] { gate.set_value(); });
    pool.reset();
  }
  ASSERT_EQ(sink.frames.size() + sink.drops.size(), 1U);
  if (!sink.frames.empty()) {
    EXPECT_LE(max_difference(*sink.frames[0].picture, gradient()), 12);
  }
}

/// Sends every damaged JPEG of the shared data as a tile: the frame is dropped, or its tile is a whole picture of the
/// announced size.
TEST_F(FrameAssemblerTest, survives_every_bad_jpeg_as_a_tile) {
  int tried = 0;
  for (const char* const folder : {"bad/afl_jpeg", "bad/go_fuzz_jpeg"}) {
    CYCLORAMA_SHARED_DATA(path, folder);
    for (const auto& entry : std::filesystem::directory_iterator(path)) {
      if (!entry.is_regular_file() || entry.path().filename() == "LICENSE") continue;
      const auto bytes = read_file(entry.path(), std::size_t{16} << 20);
      ASSERT_TRUE(bytes);
      const std::size_t before = sink_.frames.size() + sink_.drops.size();
      // Announces the size in its header, so that its contents are decoded too.
      const auto size = JpegDecoder().size_of(*bytes);
      const int width = size ? std::min(size->width, 16384) : 64;
      const int height = size ? std::min(size->height, 16384) : 64;
      const Panorama panorama{width, height, 1.0, 0.5, -0.5};
      if (static_cast<std::size_t>(width) * static_cast<std::size_t>(height) > kMaxFramePx) continue;
      Messages messages(3);
      *messages[0].mutable_begin() = view_of(7, panorama);
      wire::Tile* const tile = messages[1].mutable_tile();
      tile->set_view_number(7);
      tile->set_width_px(static_cast<std::uint32_t>(width));
      tile->set_height_px(static_cast<std::uint32_t>(height));
      tile->set_jpeg(bytes->data(), bytes->size());
      *messages[2].mutable_end() = end_of(7, 1);
      send(messages);
      ASSERT_TRUE(sink_.wait_for(before + 1)) << entry.path();
      ++tried;
    }
  }
  std::printf("%d bad JPEGs tried as tiles: %zu frames dropped, %zu shown\n", tried, sink_.drops.size(),
              sink_.frames.size());
  EXPECT_GT(tried, 40);
  EXPECT_GT(sink_.drops.size(), 20U);
  send(good(8));
  const std::size_t outcomes = sink_.frames.size() + sink_.drops.size();
  ASSERT_TRUE(sink_.wait_for(outcomes));
}

/// A display whose heads show two eyes' pictures.
class StereoFrameAssemblerTest : public FrameAssemblerTest {
 protected:
  static ShownByHeads heads_for_two() {
    ShownByHeads shown = heads_that_see_all();
    shown.stereo = true;
    return shown;
  }
  static Projection for_two(int width = 150, int height = 96) {
    return {Panorama{width, height, 2.0, 0.5, -0.5}, {Eyes::kOverUnder, 0.063, 3.0}};
  }
  void send_for_two(const Messages& messages) {
    for (const wire::ShowMessage& message : messages) stereo_.take(message);
  }
  FrameAssembler stereo_{&pool_, &sink_, &clock_, heads_for_two()};
};

TEST_F(StereoFrameAssemblerTest, returns_a_frame_when_both_eyes_are_complete) {
  const RgbImage picture = gradient(150, 192);
  send_for_two(frame_messages(1, picture, for_two()));
  send_for_two(frame_messages(2, gradient(), kPanorama));
  ASSERT_TRUE(sink_.wait_for(2));
  ASSERT_THAT(sink_.frames, ::testing::SizeIs(2));
  const DisplayFrame& two = *std::ranges::find(sink_.frames, 1U, &DisplayFrame::number);
  EXPECT_EQ(two.stacked, 2);
  EXPECT_EQ(two.shape, for_two().shape);
  EXPECT_LE(max_difference(*two.picture, picture), 12);
  EXPECT_EQ(std::ranges::find(sink_.frames, 2U, &DisplayFrame::number)->stacked, 1)
      << "one picture is good for both eyes";
}

TEST_F(StereoFrameAssemblerTest, drops_a_frame_that_lacks_any_tile_of_either_eye) {
  const Messages whole = frame_messages(1, gradient(150, 192), for_two());
  for (std::size_t lost = 1; lost + 1 < whole.size(); ++lost) {
    Messages messages = whole;
    messages.erase(messages.begin() + static_cast<std::ptrdiff_t>(lost));
    messages.back().mutable_end()->set_tiles(static_cast<std::uint32_t>(whole.size() - 3));
    send_for_two(messages);
    ASSERT_TRUE(sink_.wait_for(lost));
    ASSERT_THAT(sink_.drops, ::testing::SizeIs(lost));
    EXPECT_THAT(sink_.drops.back().second, HasSubstr("cells of the picture are empty"));
  }
  EXPECT_THAT(sink_.frames, ::testing::IsEmpty());
}

TEST_F(StereoFrameAssemblerTest, never_mixes_one_eye_of_a_frame_with_the_other_of_the_next) {
  Messages mixed = frame_messages(1, gradient(150, 192), for_two());
  const Messages next = frame_messages(2, gradient(150, 192), for_two());
  for (std::size_t i = 1; i + 1 < mixed.size(); ++i) {
    if (mixed[i].tile().y_px() >= 96) mixed[i] = next[i];
  }
  send_for_two(mixed);
  send_for_two(next);
  ASSERT_TRUE(sink_.wait_for(2));
  ASSERT_THAT(sink_.drops, ::testing::SizeIs(1));
  EXPECT_THAT(sink_.drops[0].second, HasSubstr("a tile of frame 2 came between its own"));
  ASSERT_THAT(sink_.frames, ::testing::SizeIs(1));
  EXPECT_EQ(sink_.frames[0].number, 2U);
}

TEST_F(StereoFrameAssemblerTest, decodes_the_parts_of_both_eyes_that_a_head_shows) {
  // A head that lights the lower half of the wall's picture.
  warp::PixelMap map(2, 64);
  for (int y = 0; y < 64; ++y) {
    for (const int x : {0, 1}) {
      map.at(x, y)[0] = x == 0 ? -0.9f : 0.9f;
      map.at(x, y)[1] = -0.5f * static_cast<float>(y) / 64.0f;
    }
  }
  ShownByHeads shown{{HeadFootprint(map, warp::MaskImage(2, 64, 1.0f))}, Panorama{150, 192, 2.0, 0.5, -0.5}, true};
  FrameAssembler assembler(&pool_, &sink_, &clock_, std::move(shown));
  for (const wire::ShowMessage& message : frame_messages(1, gradient(150, 384), for_two(150, 192), 0.0, 32)) {
    assembler.take(message);
  }
  ASSERT_TRUE(sink_.wait_for(1));
  ASSERT_THAT(sink_.frames, ::testing::SizeIs(1));
  const DisplayFrame& frame = sink_.frames[0];
  EXPECT_EQ(frame.tiles, 5U * 12U);
  EXPECT_EQ(frame.decoded, 5U * 2U * 4U) << "the lower half and what filters need above it";
  int rows[2] = {0, 0};
  for (const PixelRect& part : *frame.parts) {
    EXPECT_TRUE(part.y >= 192 || part.y + part.height <= 192) << "never across the seam";
    rows[part.y >= 192 ? 1 : 0] += part.height;
  }
  EXPECT_EQ(rows[0], rows[1]);
}

TEST_F(FrameAssemblerTest, drops_a_stereo_frame_for_mono_heads) {
  const Projection two{Panorama{150, 96, 2.0, 0.5, -0.5}, {Eyes::kOverUnder, 0.063, 3.0}};
  expect_dropped(frame_messages(7, gradient(150, 192), two), "a picture for two eyes");
}

}  // namespace
}  // namespace cyclorama::display
