// SPDX-License-Identifier: Apache-2.0
// A node without threads and network: tests its replies to commands.
#include "renderfarm/node/node_controller.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <map>
#include <thread>
#include <vector>

#include "common/image/cells.h"
#include "tests/doubles/fake_block_renderer.h"

namespace cyclorama::node {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr int kWidth = 512;
constexpr int kHeight = 256;

/// A block that covers the left half or all of a picture of two tiles.
wire::NodeCommand block(std::uint64_t number, std::uint64_t rank = 0, std::uint32_t width = kWidth) {
  wire::NodeCommand command;
  wire::RenderBlock& render = *command.mutable_render();
  render.set_block(number);
  render.set_rank(rank);
  render.set_scene("grotto");
  render.set_session(1);
  render.set_width_px(width);
  render.set_height_px(kHeight);
  wire::View& view = *render.mutable_view();
  view.set_number(1);
  view.set_samples(1);
  view.set_jpeg_quality(90);
  view.mutable_panorama()->set_width_px(kWidth);
  view.mutable_panorama()->set_height_px(kHeight);
  view.mutable_panorama()->set_azimuth_span_rad(2.0);
  view.mutable_panorama()->set_tan_elevation_top(0.5);
  view.mutable_panorama()->set_tan_elevation_bottom(-0.5);
  return command;
}
wire::NodeCommand kept(wire::NodeCommand command, std::uint32_t first, std::uint32_t samples) {
  command.mutable_render()->set_keep(true);
  command.mutable_render()->mutable_view()->set_first_sample(first);
  command.mutable_render()->mutable_view()->set_samples(samples);
  return command;
}
wire::NodeCommand cancel(std::uint64_t number) {
  wire::NodeCommand command;
  command.mutable_cancel()->set_block(number);
  return command;
}

class NodeControllerTest : public testing::Test {
 protected:
  std::shared_ptr<NodeLink> opened(const std::string& path = "a") {
    auto link = controller.open();
    wire::NodeCommand command;
    command.mutable_load_scene()->set_scene("grotto");
    command.mutable_load_scene()->set_path(path);
    EXPECT_TRUE(controller.take(link, command));
    while (controller.loads().work()) {
    }
    const auto answer = link->pop(SteadyClock().now());
    EXPECT_TRUE(answer && std::get<wire::NodeReport>(*answer).scene_loaded().error().empty());
    return link;
  }
  void take(const std::shared_ptr<NodeLink>& to, const wire::NodeCommand& command) {
    const Status fine = controller.take(to, command);
    EXPECT_TRUE(fine) << fine.error().message();
  }
  /// Returns all queued replies, such as "tile 3", "end 3", "end 4: cancelled", "dropped grotto".
  std::vector<std::string> sent(NodeLink& from) {
    std::vector<std::string> all;
    while (const auto item = from.pop(SteadyClock().now())) {
      if (const auto* const tile = std::get_if<RenderedTile>(&*item)) {
        all.push_back("tile " + std::to_string(tile->block));
        pictures[tile->block].push_back(tile->pixels);
      } else if (const auto* const end = std::get_if<RenderedBlock>(&*item)) {
        all.push_back("end " + std::to_string(end->block) + (end->error.empty() ? "" : ": " + end->error));
        ends[end->block] = *end;
      } else {
        const auto& report = std::get<wire::NodeReport>(*item);
        if (report.has_scene_dropped()) all.push_back("dropped " + report.scene_dropped().scene());
        if (report.has_scene_loaded()) all.push_back("loaded " + report.scene_loaded().scene());
        if (report.has_status()) all.push_back(report.status().draining() ? "draining" : "status");
      }
    }
    return all;
  }
  std::vector<std::string> all_work(NodeLink& from) {
    std::vector<std::string> all;
    while (controller.renders().work()) {
      for (std::string& item : sent(from)) all.push_back(std::move(item));
    }
    return all;
  }

  std::shared_ptr<FakeRendering> rendering = std::make_shared<FakeRendering>();
  NodeController controller{fake_loader(rendering), 0};
  std::map<std::uint64_t, std::vector<RgbImage>> pictures;
  std::map<std::uint64_t, RenderedBlock> ends;
};

TEST_F(NodeControllerTest, renders_blocks_by_rank_and_switches_between_tiles) {
  const auto link = opened();
  take(link, block(1, 5));
  take(link, block(2, 5));
  ASSERT_TRUE(controller.renders().work());
  EXPECT_THAT(sent(*link), ElementsAre("tile 1"));
  take(link, block(3, 2));
  EXPECT_EQ(controller.renders().waiting(), 3u);
  EXPECT_THAT(all_work(*link),
              ElementsAre("tile 3", "tile 3", "end 3", "tile 1", "end 1", "tile 2", "tile 2", "end 2"));
  EXPECT_EQ(controller.renders().waiting(), 0u);
}

TEST_F(NodeControllerTest, reports_the_cost_of_each_cell_of_a_block) {
  const auto link = opened();
  wire::NodeCommand command = block(1);
  command.mutable_render()->set_x_px(32);
  command.mutable_render()->set_y_px(16);
  command.mutable_render()->set_width_px(kWidth - 32);
  command.mutable_render()->set_height_px(kHeight - 16);
  for (const bool denoise : {false, true}) {
    command.mutable_render()->mutable_view()->set_denoise(denoise);
    take(link, command);
    all_work(*link);
    EXPECT_EQ(ends[1].cost.cell_cpu_seconds.size(), 30u * 15u);
    EXPECT_THAT(ends[1].cost.cell_cpu_seconds, testing::Each(FakeBlockRenderer::kCellSeconds)) << denoise;
  }
  take(link, kept(command, 0, 4));
  all_work(*link);
  EXPECT_THAT(ends[1].cost.cell_cpu_seconds, testing::Each(4 * FakeBlockRenderer::kCellSeconds)) << "of four samples";
}

TEST_F(NodeControllerTest, preempts_a_refinement_within_a_tile_and_neither_loses_nor_repeats_a_cell) {
  const auto calm = opened();
  take(calm, kept(block(1, 100), 0, 4));
  all_work(*calm);
  const std::vector<RgbImage> expected = pictures[1];
  const int cells = rendering->film_cells;
  EXPECT_EQ(cells, 3 * 512);  // Three ranges of samples.

  const auto link = opened("b");
  int moving = 0;
  int next = cells + 50;
  rendering->set_before_cell([&] {
    if (rendering->film_cells != next || moving >= 5) return;
    next += 250 + 16;  // Cells of the refinement, and of the moving picture.
    take(link, block(100 + static_cast<std::uint64_t>(++moving), 1, 16));
  });
  take(link, kept(block(2, 100), 0, 4));
  const std::vector<std::string> order = all_work(*link);
  rendering->set_before_cell(nullptr);
  EXPECT_THAT(order, ElementsAre("tile 101", "end 101", "tile 102", "end 102", "tile 103", "end 103", "tile 2",
                                 "tile 104", "end 104", "tile 105", "end 105", "tile 2", "end 2"));
  EXPECT_EQ(pictures[2], expected);
  EXPECT_EQ(rendering->film_cells - cells, cells + 5 * 16);
}

wire::NodeCommand of_account(std::uint64_t account, wire::NodeCommand command, bool denoise = false) {
  command.mutable_render()->set_account(account);
  command.mutable_render()->mutable_view()->set_denoise(denoise);
  return command;
}

TEST_F(NodeControllerTest, preempts_moving_pictures_within_a_tile_and_neither_loses_nor_repeats_a_cell) {
  for (const bool denoise : {false, true}) {
    const auto calm = opened();
    take(calm, of_account(1, block(1, 100), denoise));
    all_work(*calm);
    const std::vector<RgbImage> expected = pictures[1];
    pictures.clear();
    const int before = rendering->film_cells;
    bool has_come = false;
    rendering->set_before_cell([&] {
      if (rendering->film_cells != before + 50 || has_come) return;
      has_come = true;
      take(calm, of_account(2, block(3, 1, 16)));
    });
    take(calm, of_account(1, block(2, 100), denoise));
    const std::vector<std::string> order = all_work(*calm);
    rendering->set_before_cell(nullptr);
    EXPECT_THAT(order, ElementsAre("tile 3", "end 3", "tile 2", "tile 2", "end 2")) << denoise;
    EXPECT_EQ(pictures[2], expected) << denoise;
    EXPECT_EQ(rendering->film_cells - before, 512 + 16) << denoise;
    pictures.clear();
  }
}

TEST_F(NodeControllerTest, loses_one_block_and_nothing_else_when_memory_is_short) {
  const auto link = opened();
  for (const bool denoise : {false, true}) {
    take(link, of_account(1, block(1, 1), denoise));
    rendering->lacks_memory = true;
    EXPECT_THAT(all_work(*link), ElementsAre("end 1: this node has not enough memory for the block"));
    rendering->lacks_memory = false;
    take(link, of_account(1, block(2, 2), denoise));
    EXPECT_THAT(all_work(*link), ElementsAre("tile 2", "tile 2", "end 2")) << denoise;
  }
}

TEST_F(NodeControllerTest, adds_to_existing_samples_unless_the_session_ended) {
  const auto link = opened();
  take(link, kept(block(1), 0, 4));
  all_work(*link);
  const int first = rendering->film_cells;
  take(link, kept(block(2), 4, 4));
  all_work(*link);
  EXPECT_EQ(rendering->film_cells - first, 512) << "one piece";
  wire::NodeCommand forget;
  forget.mutable_forget_session()->set_session(1);
  take(link, forget);
  take(link, kept(block(3), 4, 4));
  all_work(*link);
  EXPECT_EQ(rendering->film_cells - first, 512 + 4 * 512) << "all four";
  EXPECT_EQ(pictures[3], pictures[2]);
}

TEST_F(NodeControllerTest, ends_a_cancelled_block_at_once_whether_it_waits_or_is_half_done) {
  const auto link = opened();
  take(link, block(1, 1));
  take(link, block(2, 2));
  take(link, block(3, 3));
  ASSERT_TRUE(controller.renders().work());
  take(link, cancel(3));
  take(link, cancel(1));
  take(link, cancel(77));
  EXPECT_THAT(all_work(*link),
              ElementsAre("tile 1", "end 1: cancelled", "end 3: cancelled", "tile 2", "tile 2", "end 2"));
  EXPECT_EQ(rendering->renders, 3);
  // The blocks are cancelled in the middle of a tile, of a moving picture and of one at rest.
  take(link, kept(block(4), 0, 64));
  rendering->set_before_cell([&] { take(link, cancel(4)); });
  EXPECT_THAT(all_work(*link), ElementsAre("end 4: cancelled"));
}

TEST_F(NodeControllerTest, keeps_two_coordinators_apart) {
  const auto one = opened();
  const auto other = opened();
  take(one, kept(block(1), 0, 2));
  take(other, kept(block(1), 0, 2));
  EXPECT_THAT(all_work(*one), ElementsAre("tile 1", "tile 1", "end 1"));
  EXPECT_THAT(sent(*other), ElementsAre("tile 1", "tile 1", "end 1"));
  EXPECT_EQ(rendering->film_cells, 2 * 2 * 512) << "session 1 of another coordinator is another session";
  take(one, block(2));
  take(other, block(2));
  take(other, cancel(2));
  controller.close(*one);
  EXPECT_THAT(all_work(*other), ElementsAre("end 2: cancelled"));
  take(other, block(3));
  EXPECT_THAT(all_work(*other), ElementsAre("tile 3", "tile 3", "end 3")) << "scenes stay";
}

TEST_F(NodeControllerTest, continues_for_a_coordinator_that_takes_tiles_while_another_takes_none) {
  const auto stuck = opened();
  const auto link = opened();
  for (std::uint64_t number = 1; number <= 8; ++number) take(stuck, block(number, 0));
  take(link, block(1, 9));
  std::vector<std::string> order = all_work(*link);
  EXPECT_THAT(order, ElementsAre("tile 1", "tile 1", "end 1"));
  EXPECT_GT(controller.renders().waiting(), 0u);
  EXPECT_LT(sent(*stuck).size(), 8u) << "a few, not all";
  while (controller.renders().waiting() > 0) {
    ASSERT_TRUE(controller.renders().work());
    sent(*stuck);
  }
}

TEST_F(NodeControllerTest, reports_what_is_wrong_with_a_block) {
  const auto link = opened();
  wire::NodeCommand unknown = block(1);
  unknown.mutable_render()->set_scene("cave");
  wire::NodeCommand crooked = block(2);
  crooked.mutable_render()->set_x_px(7);
  take(link, unknown);
  take(link, crooked);
  EXPECT_THAT(all_work(*link), ElementsAre("end 1: scene 'cave' is not loaded", HasSubstr("end 2: ")));
  take(link, block(3));
  EXPECT_THAT(controller.take(link, block(3)).error().message(), HasSubstr("block 3 twice"));
  wire::NodeCommand huge = block(4);
  huge.mutable_render()->set_scene(std::string(5000, 'x'));
  EXPECT_FALSE(controller.take(link, huge));
}

TEST_F(NodeControllerTest, renders_loaded_scenes_while_it_loads_another) {
  const auto link = opened();
  wire::NodeCommand load;
  load.mutable_load_scene()->set_scene("cave");
  load.mutable_load_scene()->set_path("b");
  take(link, load);
  take(link, block(1));
  EXPECT_THAT(all_work(*link), ElementsAre("tile 1", "tile 1", "end 1"));
  ASSERT_TRUE(controller.loads().work());
  EXPECT_THAT(sent(*link), ElementsAre("loaded cave"));
}

TEST_F(NodeControllerTest, informs_every_coordinator_when_a_scene_was_dropped) {
  NodeController small(fake_loader(rendering), 2000);  // 500 bytes for films; the fake scenes take 1000 each.
  const auto one = small.open();
  const auto other = small.open();
  const auto load = [&](const std::shared_ptr<NodeLink>& link, const char* scene) {
    wire::NodeCommand command;
    command.mutable_load_scene()->set_scene(scene);
    command.mutable_load_scene()->set_path(scene);
    EXPECT_TRUE(small.take(link, command));
    EXPECT_TRUE(small.loads().work());
  };
  load(one, "grotto");
  load(other, "grotto");
  load(other, "cave");
  EXPECT_THAT(sent(*one), ElementsAre("loaded grotto", "dropped grotto"));
  EXPECT_THAT(sent(*other), ElementsAre("loaded grotto", "dropped grotto", "loaded cave"));
}

TEST_F(NodeControllerTest, reports_its_state_and_that_it_drains) {
  const auto link = opened();
  take(link, block(1));
  const wire::NodeStatus status = controller.status().status();
  EXPECT_GT(status.memory_bytes(), 1u << 20);
  EXPECT_EQ(status.blocks_waiting(), 1u);
  EXPECT_GE(status.uptime_s(), 0.0);
  EXPECT_FALSE(status.draining());
  controller.drain();
  EXPECT_TRUE(controller.status().status().draining());
  EXPECT_THAT(all_work(*link), ElementsAre("draining", "tile 1", "tile 1", "end 1"));
  link->finish();
  take(link, block(2));
  EXPECT_THAT(all_work(*link), ElementsAre()) << "nothing after the end";
  EXPECT_TRUE(link->is_finished());
}

/// A node with two lanes, each served by a thread.
class NodeLanes : public NodeControllerTest {
 protected:
  NodeLanes() {
    for (std::size_t lane = 0; lane < node.renders().lanes(); ++lane) {
      threads.emplace_back([this, lane] {
        while (node.renders().wait()) node.renders().work(lane);
      });
    }
  }
  ~NodeLanes() override {
    node.renders().stop();
    for (std::thread& thread : threads) thread.join();
  }
  std::shared_ptr<NodeLink> opened_node() {
    auto link = node.open();
    wire::NodeCommand command;
    command.mutable_load_scene()->set_scene("grotto");
    command.mutable_load_scene()->set_path("a");
    EXPECT_TRUE(node.take(link, command));
    while (node.loads().work()) {
    }
    EXPECT_TRUE(link->pop(SteadyClock().now()));
    return link;
  }
  /// Waits for a block's end and adds all replies until then to `ends` and `pictures`.
  bool wait_for_end(NodeLink& link, std::uint64_t block) {
    const TimePoint deadline = SteadyClock().now() + std::chrono::seconds(20);
    while (!ends.contains(block) && SteadyClock().now() < deadline) {
      if (const auto item = link.pop(SteadyClock().now() + std::chrono::milliseconds(5))) {
        if (const auto* const tile = std::get_if<RenderedTile>(&*item)) pictures[tile->block].push_back(tile->pixels);
        if (const auto* const end = std::get_if<RenderedBlock>(&*item)) ends[end->block] = *end;
      }
      node.renders().link_moved();
    }
    return ends.contains(block);
  }

  NodeController node{fake_loader(rendering), 0, {}, nullptr, std::make_shared<render::Crew>(2)};
  std::vector<std::thread> threads;
};

TEST_F(NodeLanes, render_a_block_while_another_is_in_the_middle_of_a_tile) {
  ASSERT_EQ(node.renders().lanes(), 2u);
  const auto link = opened_node();
  std::atomic<bool> has_come = false;
  bool has_ended = false;
  rendering->set_before_cell([&] {
    if (rendering->film_cells < 20 || has_come.exchange(true)) return;
    EXPECT_TRUE(node.take(link, block(2, 1)));
    has_ended = wait_for_end(*link, 2);
  });
  ASSERT_TRUE(node.take(link, block(1, 100)));
  while (!has_come) std::this_thread::yield();
  ASSERT_TRUE(wait_for_end(*link, 1));
  rendering->set_before_cell(nullptr);
  EXPECT_TRUE(has_ended) << "before the first went on";
  EXPECT_EQ(pictures[1], pictures[2]);
  EXPECT_EQ(rendering->film_cells, 2 * 512) << "no cell twice";
}

TEST_F(NodeLanes, end_each_block_once_when_some_are_cancelled_and_a_link_is_dropped) {
  const auto link = opened_node();
  const auto other = opened_node();
  constexpr std::uint64_t kBlocks = 16;
  for (std::uint64_t number = 1; number <= kBlocks; ++number) {
    wire::NodeCommand command = number % 3 == 0 ? kept(block(number, number), 0, 4) : block(number, number);
    command.mutable_render()->set_account(number % 4);
    command.mutable_render()->mutable_view()->set_denoise(number % 3 == 1);
    ASSERT_TRUE(node.take(link, command));
    ASSERT_TRUE(node.take(other, block(number)));
    if (number % 5 == 0) {
      EXPECT_TRUE(node.take(link, cancel(number)));
    }
  }
  node.close(*other);
  for (std::uint64_t number = 1; number <= kBlocks; ++number) {
    ASSERT_TRUE(wait_for_end(*link, number)) << number;
    if (ends[number].error.empty()) {
      EXPECT_EQ(pictures[number].size(), 2u) << number;
    } else {
      EXPECT_EQ(number % 5, 0u) << ends[number].error;
    }
  }
  EXPECT_TRUE(node.renders().wait_until_idle(SteadyClock().now() + std::chrono::seconds(20), {}));
}

TEST_F(NodeControllerTest, waits_until_nothing_is_queued) {
  const auto link = opened();
  const auto idle = [&] {
    return controller.renders().wait_until_idle(SteadyClock().now() + std::chrono::milliseconds(20),
                                                std::chrono::milliseconds(1));
  };
  EXPECT_TRUE(idle());
  take(link, block(1));
  EXPECT_FALSE(idle());
  all_work(*link);
  EXPECT_TRUE(idle());
}

}  // namespace
}  // namespace cyclorama::node
