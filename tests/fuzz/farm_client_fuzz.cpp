// SPDX-License-Identifier: Apache-2.0
// Whatever a coordinator sends, a museum's client delivers only complete pictures of requested views. Input: one byte
// selects the event, the next ones its parameters; an arbitrary message is one byte of length and that many bytes of
// protobuf.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/base/check.h"
#include "renderfarm/client/view_window.h"
#include "tests/doubles/fake_scene.h"
#include "tests/fuzz/fuzz_input.h"

namespace {

using namespace cyclorama;

constexpr std::uint32_t kMaxSidePx = 80;

wire::View view_of(std::uint64_t number, std::uint32_t width, std::uint32_t height) {
  wire::View view;
  view.set_number(number);
  view.set_heading_rad(0.5);
  view.mutable_panorama()->set_width_px(width);
  view.mutable_panorama()->set_height_px(height);
  view.mutable_panorama()->set_azimuth_span_rad(1.0);
  view.mutable_panorama()->set_tan_elevation_top(0.5);
  return view;
}

/// Returns a reply that is probably valid, chosen by the bytes, or an arbitrary one.
wire::SessionReply reply_of(FuzzInput* input) {
  wire::SessionReply reply;
  switch (input->byte() % 6) {
    case 0:
      *reply.mutable_opened() = fake_scene("a");
      break;
    case 1: {
      const std::uint32_t number = input->byte();
      const std::uint32_t width = input->byte() % (kMaxSidePx + 1);
      *reply.mutable_begin() = view_of(number, width, input->byte() % (kMaxSidePx + 1));
      break;
    }
    case 2:
    case 3: {
      wire::Tile& tile = *reply.mutable_tile();
      tile.set_view_number(input->byte());
      tile.set_x_px(16 * (input->byte() % 6));
      tile.set_y_px(16 * (input->byte() % 6));
      tile.set_width_px(input->byte() % (kMaxSidePx + 1));
      tile.set_height_px(input->byte() % (kMaxSidePx + 1));
      break;
    }
    case 4: {
      wire::FrameEnd& end = *reply.mutable_end();
      end.set_view_number(input->byte());
      end.set_tiles(input->byte());
      end.set_complete(input->byte() % 4 != 0);
      break;
    }
    case 5: {
      const auto bytes = input->bytes(input->byte());
      if (!reply.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) reply.Clear();
      break;
    }
  }
  return reply;
}

/// Checks the guarantees on which a listener relies.
class Museum {
 public:
  void take(const wire::SessionReply& reply) {
    if (reply.has_opened()) opened_ = true;
    CHECK(opened_);
    if (reply.has_begin()) begin(reply.begin());
    if (reply.has_tile()) paint(reply.tile());
    if (reply.has_end()) end(reply.end());
  }
  void lose(const std::optional<std::uint64_t>& number) {
    CHECK(number.has_value() == open_.has_value());
    CHECK(!open_ || open_->number() == *number);
    open_.reset();
    opened_ = false;
  }

 private:
  void begin(const wire::View& view) {
    CHECK(!open_ && std::isfinite(view.heading_rad()));
    open_ = view;
    painted_.assign(std::size_t{view.panorama().width_px()} * view.panorama().height_px(), 0);
  }
  void paint(const wire::Tile& tile) {
    CHECK(open_ && open_->number() == tile.view_number());
    const std::uint32_t width = open_->panorama().width_px();
    for (std::uint32_t y = tile.y_px(); y < tile.y_px() + tile.height_px(); ++y) {
      for (std::uint32_t x = tile.x_px(); x < tile.x_px() + tile.width_px(); ++x) {
        CHECK(++painted_.at(std::size_t{y} * width + x) == 1);
      }
    }
  }
  void end(const wire::FrameEnd& end) {
    CHECK(open_ && open_->number() == end.view_number());
    CHECK(!end.complete() || std::ranges::count(painted_, 0) == 0);
    open_.reset();
  }

  bool opened_ = false;
  std::optional<wire::View> open_;
  std::vector<int> painted_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzInput input(data, size);
  client::ViewWindow window;
  Museum museum;
  std::uint64_t newest = 0;
  while (!input.is_empty()) {
    switch (input.byte() % 8) {
      case 0: {
        const std::uint32_t width = 1 + input.byte() % kMaxSidePx;
        window.put(view_of(++newest, width, 1 + input.byte() % kMaxSidePx));
        break;
      }
      case 1:
        window.take_sendable();
        break;
      case 2:
        museum.lose(window.lose());
        break;
      default: {
        const wire::SessionReply reply = reply_of(&input);
        if (window.take(reply)) museum.take(reply);
        break;
      }
    }
    CHECK(window.in_flight() <= kFramesInFlight);
  }
  return 0;
}
