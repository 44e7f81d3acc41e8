// SPDX-License-Identifier: Apache-2.0
// Whatever coordinators send, a node neither crashes nor loses its consistency: messages are read from the input and
// given to NodeController, interleaved with the work of its threads. Input: one byte selects the event, one byte is a
// length, followed by that many bytes of protobuf.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "renderfarm/node/node_controller.h"
#include "renderfarm/node/tile_sender.h"
#include "tests/doubles/fake_block_renderer.h"

namespace {

using namespace cyclorama;

/// Larger pictures would only take time.
constexpr std::int64_t kMaxPixels = 128 * 128;

/// A stream, its sender, and the coordinator's guarantee: every block that it gave has one end, unless it is gone.
struct Coordinator {
  std::shared_ptr<node::NodeLink> link;
  std::unique_ptr<node::TileSender> sender;
  std::size_t blocks = 0;
  std::size_t ends = 0;

  void take_all() {
    std::vector<node::NodeLink::Outgoing> items;
    while (auto item = link->pop(TimePoint())) items.push_back(*std::move(item));
    for (const wire::NodeReport& report : sender->reports_of(std::move(items))) ends += report.has_end() ? 1 : 0;
  }
};

void open(node::NodeController& controller, Coordinator& coordinator) {
  coordinator = Coordinator{controller.open(), std::make_unique<node::TileSender>(controller.renders().crew()), 0, 0};
  wire::NodeCommand load;
  load.mutable_load_scene()->set_scene("a");
  load.mutable_load_scene()->set_path("a");
  CHECK(controller.take(coordinator.link, load));
  while (controller.loads().work()) {
  }
}

/// Returns a command of another kind that is probably valid, chosen by the bytes.
wire::NodeCommand sound_other(const std::uint8_t* bytes, std::size_t length) {
  std::array<std::uint8_t, 3> chosen{};
  std::copy_n(bytes, std::min(length, chosen.size()), chosen.begin());
  wire::NodeCommand command;
  switch (chosen[0] % 3) {
    case 0: {
      wire::LoadScene& load = *command.mutable_load_scene();
      load.set_scene(std::string(1, static_cast<char>('a' + chosen[1] % 4)));
      if (chosen[1] / 4 % 4 == 3) {
        load.set_digest(std::string(64, 'd'));
      } else {
        load.set_path(load.scene());
      }
      for (int bit = 0; bit < 4; ++bit) {
        if ((chosen[2] >> bit & 1) == 1) load.add_in_use(std::string(1, static_cast<char>('a' + bit)));
      }
      break;
    }
    case 1:
      command.mutable_cancel()->set_block(chosen[1]);
      break;
    case 2:
      command.mutable_forget_session()->set_session(chosen[1] % 4);
      break;
  }
  return command;
}

/// Returns a block that a node renders, chosen by the bytes: number, rank, kind, samples, session.
wire::NodeCommand sound_block(const std::uint8_t* bytes, std::size_t length) {
  std::array<std::uint8_t, 5> chosen{};
  std::copy_n(bytes, std::min(length, chosen.size()), chosen.begin());
  wire::NodeCommand command;
  wire::RenderBlock& block = *command.mutable_render();
  block.set_block(chosen[0]);
  block.set_rank(chosen[1]);
  block.set_scene(chosen[4] / 4 % 8 == 7 ? "b" : "a");
  block.set_keep(chosen[2] % 2 == 1);
  block.set_session(chosen[4] % 4);
  block.set_width_px(96);
  block.set_height_px(48);
  wire::View& view = *block.mutable_view();
  view.set_number(1 + chosen[2] / 16);
  view.set_denoise(chosen[2] / 2 % 2 == 1);
  view.set_samples(1 + chosen[3] % 8);
  view.set_first_sample(chosen[3] / 8 % 8);
  view.set_jpeg_quality(90);
  view.mutable_panorama()->set_width_px(96);
  view.mutable_panorama()->set_height_px(48);
  view.mutable_panorama()->set_azimuth_span_rad(1.0);
  view.mutable_panorama()->set_tan_elevation_top(1.0);
  return command;
}

void close(node::NodeController& controller, Coordinator& coordinator) {
  controller.close(*coordinator.link);
  CHECK(coordinator.link->is_closed());
}

void order(node::NodeController& controller, Coordinator& coordinator, wire::NodeCommand& command) {
  if (command.has_render()) {
    // The wire's limits are far larger and have a test of their own.
    const wire::Panorama& panorama = command.render().view().panorama();
    if (std::int64_t{panorama.width_px()} * panorama.height_px() > kMaxPixels) return;
    if (command.render().view().samples() > 8) command.mutable_render()->mutable_view()->set_samples(8);
    if (command.render().view().first_sample() > 8) command.mutable_render()->mutable_view()->set_first_sample(8);
  }
  if (controller.take(coordinator.link, command)) {
    if (command.has_render()) ++coordinator.blocks;
    return;
  }
  close(controller, coordinator);
  open(controller, coordinator);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  node::NodeController controller(fake_loader(), 3000);  // Room for two of the fake scenes.
  std::array<Coordinator, 2> coordinators;
  for (Coordinator& coordinator : coordinators) open(controller, coordinator);
  while (size >= 2) {
    const unsigned what = data[0];
    const std::size_t length = std::min<std::size_t>(data[1], size - 2);
    Coordinator& coordinator = coordinators[what / 8 % coordinators.size()];
    wire::NodeCommand command;
    switch (what % 8) {
      case 2:
        command = sound_other(data + 2, length);
        order(controller, coordinator, command);
        break;
      case 3:
        command = sound_block(data + 2, length);
        order(controller, coordinator, command);
        break;
      case 4:
        close(controller, coordinator);
        open(controller, coordinator);
        break;
      case 5:
        controller.renders().work();
        break;
      case 6:
        controller.loads().work();
        break;
      case 7:
        coordinator.take_all();
        controller.renders().link_moved();
        break;
      default:
        if (command.ParseFromArray(data + 2, static_cast<int>(length))) order(controller, coordinator, command);
        break;
    }
    data += 2 + length;
    size -= 2 + length;
  }
  while (controller.loads().work()) {
  }
  do {
    for (Coordinator& coordinator : coordinators) coordinator.take_all();  // Makes room for more.
  } while (controller.renders().work());
  CHECK(controller.renders().waiting() == 0);
  for (const Coordinator& coordinator : coordinators) CHECK(coordinator.ends == coordinator.blocks);
  return 0;
}
