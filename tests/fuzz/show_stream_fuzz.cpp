// SPDX-License-Identifier: Apache-2.0
// Messages of the Show stream for the frame assembler and the tour's clock. The input is a program: each step sends one
// message, either arbitrary bytes, or a begin, tile, end or lost stream with numbers from the input, so that complete
// frames occur.
#include <array>
#include <cmath>
#include <future>
#include <map>
#include <utility>

#include "appliance/display/frame_assembler.h"
#include "appliance/display/tour_clock.h"
#include "tests/data_sets/heads_that_see_all.h"
#include "tests/data_sets/jpeg_tiles.h"
#include "tests/fuzz/fuzz_input.h"

namespace cyclorama {
namespace {

/// Checks that ready frames are complete and that each frame has one outcome.
class CheckingSink final : public display::FrameSink {
 public:
  void frame_ready(display::DisplayFrame frame) override {
    CHECK(frame.picture != nullptr && validate(frame.shape));
    CHECK(frame.picture->width() == width_px(frame.shape) && frame.picture->height() == height_px(frame.shape));
    CHECK(frame.order > 0 && frame.number > 0);
    CHECK(frame.show_at.period_ns == 0 || std::abs(static_cast<double>(frame.show_at.refresh) *
                                                   static_cast<double>(frame.show_at.period_ns)) <= 0x1p62);
  }
  void frame_dropped(std::uint64_t, const std::string& reason) override { CHECK(!reason.empty()); }
};

const std::string& jpeg_of(int width, int height) {
  static std::map<std::pair<int, int>, std::string> made;
  std::string& jpeg = made[{width, height}];
  if (jpeg.empty()) {
    const auto encoded = JpegEncoder().encode(RgbImage(width, height, 99), {80, true});
    CHECK(encoded.has_value());
    jpeg.assign(reinterpret_cast<const char*>(encoded->data()), encoded->size());
  }
  return jpeg;
}

wire::Tile tile_from(FuzzInput* input) {
  wire::Tile tile;
  tile.set_view_number(input->byte() % 4);
  tile.set_x_px(16 * (input->byte() % 6));
  tile.set_y_px(16 * (input->byte() % 6));
  tile.set_width_px(1 + input->byte() % 80);
  tile.set_height_px(1 + input->byte() % 80);
  *tile.mutable_jpeg() = jpeg_of(static_cast<int>(tile.width_px()), static_cast<int>(tile.height_px()));
  for (std::uint32_t damage = input->byte() % 4; damage > 0; --damage) {
    tile.mutable_jpeg()->at((input->byte() << 8 | input->byte()) % tile.jpeg().size()) =
        static_cast<char>(input->byte());
  }
  return tile;
}

wire::ShowMessage message_from(FuzzInput* input) {
  wire::ShowMessage message;
  switch (input->byte() % 5) {
    case 0: {
      const auto bytes = input->bytes(input->byte());
      if (!message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) message.Clear();
      return message;
    }
    case 1: {
      const int width = static_cast<int>(input->byte() % 90);
      const int height = static_cast<int>(input->byte() % 90);
      const std::array<PictureShape, 3> shapes{Panorama{width, height, 1.0, 0.5, -0.5},
                                               Fisheye{width, height, 1.5, 0.5},
                                               Perspective{width, height, -1.0, 1.0, 0.5, -0.5, 0.5}};
      const auto asked = input->byte();
      *message.mutable_begin() = view_of(asked % 4U, shapes[input->byte() % 3]);
      if (asked >= 128) {
        message.mutable_begin()->mutable_panorama()->mutable_eyes()->set_distance_m(0.001 * asked);
        message.mutable_begin()->mutable_panorama()->set_height_px(static_cast<std::uint32_t>(height / 32 * 32));
      }
      return message;
    }
    case 2:
    case 3:
      *message.mutable_tile() = tile_from(input);
      return message;
    default: {
      const std::uint32_t number = input->byte() % 4;
      const std::uint32_t tiles = input->byte() % 30;
      *message.mutable_end() = end_of(number, tiles, input->byte() % 8 != 0);
      message.mutable_show_at()->set_refresh(static_cast<std::int64_t>(number) << (input->byte() % 64));
      message.mutable_show_at()->set_period_ns(std::int64_t{1} << (input->byte() % 64));
      return message;
    }
  }
}

}  // namespace
}  // namespace cyclorama

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  FuzzInput input(data, size);
  SteadyClock clock;
  CheckingSink sink;
  display::TourClock tour_clock(std::chrono::system_clock::now);
  display::DecodePool pool(1);
  display::ShownByHeads shown = heads_that_see_all();
  const auto setting = input.byte();
  if (setting % 2 != 0) shown.wall = Fisheye{64, 64, 1.0, 0.5};
  shown.stereo = setting % 4 > 1;
  display::FrameAssembler assembler(&pool, &sink, &clock, std::move(shown));
  while (!input.is_empty()) {
    wire::ShowMessage message = message_from(&input);
    const auto kind = message.message_case();
    if (kind == wire::ShowMessage::MESSAGE_NOT_SET || kind == wire::ShowMessage::kHeading) {
      assembler.stream_lost();
      tour_clock.reset();
    } else if (kind == wire::ShowMessage::kClock) {
      if (const auto question = tour_clock.question(clock.now()))
        message.mutable_clock()->set_asked_ns(question->asked_ns());
      tour_clock.take(message.clock(), clock.now());
      tour_clock.heading_ready(display::show_at_of(message), clock.now());
    } else if (kind != wire::ShowMessage::kCaption) {  // caption_fuzz.cpp has these.
      assembler.take(std::move(message));
    }
  }
  // The only decode thread works in order: when it reaches this task, all earlier tiles are decoded.
  std::promise<void> done;
  pool.submit([&](JpegDecoder&) { done.set_value(); });
  CHECK(done.get_future().wait_for(std::chrono::seconds(20)) == std::future_status::ready);
  return 0;
}
