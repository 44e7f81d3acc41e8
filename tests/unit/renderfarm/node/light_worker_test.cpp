// SPDX-License-Identifier: Apache-2.0
// Light computed in a node's idle time, without a process: the worker alone, then within a node.
#include "renderfarm/node/light_worker.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <span>
#include <string_view>

#include "common/base/file.h"
#include "renderfarm/node/node_controller.h"
#include "tests/doubles/fake_block_renderer.h"
#include "tests/doubles/fake_clock.h"
#include "tests/doubles/fake_light.h"

namespace cyclorama::node {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::filesystem::path& cache() {
  static const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "light_worker_test";
  return folder;
}

/// Returns the version of a file of these bytes.
std::string version_named(std::string_view bytes) { return version_of(std::as_bytes(std::span(bytes))); }

class LightWorkerTest : public testing::Test {
 protected:
  [[nodiscard]] double reported_share() const {
    wire::NodeStatus status;
    worker.report(&status);
    return status.light_size() == 0 ? -1.0 : status.light(0).done_share();
  }

  FakeClock clock;
  std::shared_ptr<FakeLight> light = std::make_shared<FakeLight>();
  bool has_blocks = false;
  bool is_wanted = true;
  std::vector<std::string> finished;
  std::vector<std::pair<std::string, wire::LightPieces>> progressed;
  LightWorker worker{
      fake_light_starter(light),
      LightFiles(cache()),
      {[this] { return has_blocks; }, [this](const std::string&) { return is_wanted; },
       [this](const std::string& path, const wire::LightPieces& pieces) { progressed.emplace_back(path, pieces); },
       [this](const std::string& path, const std::filesystem::path&, const Status& status) {
         finished.push_back(path + (status ? "" : ": " + status.error().message()));
       }},
      clock};
};

TEST_F(LightWorkerTest, computes_one_scene_after_the_other) {
  EXPECT_FALSE(worker.work());
  worker.want("a", "grotto");
  worker.want("b", "cave");
  worker.want("a", "grotto again");
  EXPECT_TRUE(worker.work());
  light->done_share = 0.25;
  clock.advance(std::chrono::seconds(10));
  EXPECT_TRUE(worker.work());
  wire::NodeStatus status;
  worker.report(&status);
  ASSERT_EQ(status.light_size(), 2);
  EXPECT_EQ(status.light(0).scene(), "grotto");
  EXPECT_EQ(status.light(0).done_share(), 0.25);
  EXPECT_EQ(status.light(1).scene(), "cave");
  light->result = Status(Done{});
  worker.work();
  worker.work();
  worker.work();
  EXPECT_FALSE(worker.work());
  EXPECT_THAT(light->begun, ElementsAre("a", "b"));
  EXPECT_THAT(finished, ElementsAre("a", "b"));
  EXPECT_EQ(reported_share(), -1.0);
}

TEST_F(LightWorkerTest, is_paused_when_a_block_arrives_and_goes_on_when_none_has_come_for_a_while) {
  worker.want("a", "grotto");
  worker.work();
  EXPECT_FALSE(light->is_paused);
  worker.give_way();
  EXPECT_TRUE(light->is_paused) << "at once, not when the worker next looks";
  has_blocks = true;
  clock.advance(10 * LightWorker::kQuiet);
  worker.work();
  EXPECT_TRUE(light->is_paused) << "blocks still wait";
  has_blocks = false;
  clock.advance(LightWorker::kQuiet / 2);
  worker.work();
  EXPECT_TRUE(light->is_paused) << "between two frames";
  clock.advance(LightWorker::kQuiet);
  worker.work();
  EXPECT_FALSE(light->is_paused);
}

TEST_F(LightWorkerTest, does_not_begin_during_a_visit) {
  worker.give_way();
  worker.want("a", "grotto");
  worker.work();
  EXPECT_THAT(light->begun, ElementsAre());
  clock.advance(LightWorker::kQuiet);
  worker.work();
  EXPECT_THAT(light->begun, ElementsAre("a"));
}

TEST_F(LightWorkerTest, expects_the_time_that_is_left_from_the_time_that_it_worked) {
  worker.want("a", "grotto");
  worker.work();
  clock.advance(std::chrono::seconds(10));
  light->done_share = 0.5;
  worker.work();
  worker.give_way();
  clock.advance(std::chrono::hours(1));
  worker.work();
  wire::NodeStatus status;
  worker.report(&status);
  EXPECT_NEAR(status.light(0).seconds_left(), 10.0, 1e-6);
}

TEST_F(LightWorkerTest, gives_up_the_light_of_a_scene_that_was_replaced) {
  worker.want("a", "grotto");
  worker.work();
  is_wanted = false;
  EXPECT_TRUE(worker.work());
  EXPECT_TRUE(light->is_ended);
  EXPECT_FALSE(worker.work());
  EXPECT_THAT(finished, ElementsAre());
}

TEST_F(LightWorkerTest, passes_on_what_the_computation_reports_and_what_it_is_ordered) {
  wire::ComputePieces order;
  order.mutable_stage()->set_number(2);
  order.mutable_stage()->set_key("k2");
  order.add_pieces(7);
  worker.want("a", "grotto");
  worker.work();
  worker.compute("a", order);
  EXPECT_THAT(light->orders, ElementsAre()) << "it has begun no stage";
  light->events = {BegunStage{1, "k1", 4, "/pieces"}, TakenPiece{1, 3, "sha", 10}, BegunStage{2, "k2", 9, "/pieces"},
                   TakenPiece{2, 0, "sum", 11}};
  worker.work();
  ASSERT_EQ(progressed.size(), 2u);
  EXPECT_EQ(progressed[0].second.stage().key(), "k1");
  EXPECT_EQ(progressed[0].second.pieces(0).piece(), 3u);
  EXPECT_EQ(progressed[1].second.stage().pieces(), 9u);
  light->events = {TakenPiece{2, 1, "sun", 12}};
  worker.work();
  ASSERT_EQ(progressed.size(), 3u);
  EXPECT_EQ(progressed[2].second.pieces_size(), 1) << "what is new";
  EXPECT_EQ(worker.stage_of("a")->pieces_size(), 2) << "all";
  EXPECT_FALSE(worker.stage_of("b"));
  worker.compute("a", order);
  worker.compute("b", order);
  worker.fetched("a", order.stage(), 8);
  EXPECT_THAT(light->orders, ElementsAre("compute 2-7", "fetched 2-8"));
  EXPECT_EQ(worker.piece_file("a", order.stage(), 7), "/pieces/2-7");
  EXPECT_EQ(worker.piece_file("a", order.stage(), 9), "") << "there are nine";
  order.mutable_stage()->set_key("other");
  EXPECT_EQ(worker.piece_file("a", order.stage(), 7), "");
  order.mutable_stage()->set_number(1);
  order.mutable_stage()->set_key("k1");
  EXPECT_EQ(worker.piece_file("a", order.stage(), 3), "/pieces/1-3") << "for a node that comes later";
}

TEST_F(LightWorkerTest, gives_up_light_that_has_come_from_elsewhere_and_removes_its_pieces) {
  const std::filesystem::path folder = cache() / "unfinished";
  std::filesystem::create_directories(folder);
  worker.want("a", "grotto");
  worker.work();
  light->events = {BegunStage{0, "k", 1, folder}};
  worker.work();
  worker.forget("a");
  EXPECT_TRUE(worker.work());
  EXPECT_TRUE(light->is_ended);
  EXPECT_FALSE(std::filesystem::exists(folder));
  EXPECT_THAT(finished, ElementsAre());
  EXPECT_FALSE(worker.work());
}

TEST_F(LightWorkerTest, ends_the_computation_when_the_node_stops) {
  worker.want("a", "grotto");
  worker.work();
  worker.stop();
  EXPECT_FALSE(worker.wait());
  EXPECT_TRUE(light->is_ended);
  EXPECT_THAT(finished, ElementsAre());
}

TEST_F(LightWorkerTest, reports_why_nothing_can_be_written) {
  LightWorker homeless(fake_light_starter(light), LightFiles(""),
                       {[] { return false; }, [](const std::string&) { return true; },
                        [](const std::string&, const wire::LightPieces&) {},
                        [this](const std::string&, const std::filesystem::path&, const Status& status) {
                          finished.push_back(status.error().message());
                        }},
                       clock);
  homeless.want("scene.ply", "grotto");
  homeless.work();
  EXPECT_THAT(finished, ElementsAre(HasSubstr("give the node a cache")));
  EXPECT_FALSE(homeless.work());
}

class NodeLight : public testing::Test {
 protected:
  NodeLight() { rendering->can_have_light = true; }
  /// Returns the reply to the load of a scene.
  wire::SceneLoaded load(const std::string& path = "a") {
    wire::NodeCommand command;
    command.mutable_load_scene()->set_scene("grotto");
    command.mutable_load_scene()->set_path(path);
    EXPECT_TRUE(controller.take(link, command));
    EXPECT_TRUE(controller.loads().work());
    return next().scene_loaded();
  }
  void order_light() {
    wire::NodeCommand command;
    command.mutable_compute_light()->set_scene("grotto");
    EXPECT_TRUE(controller.take(link, command));
  }
  /// Has the light computed; its file has these bytes.
  void compute(const std::string& bytes) {
    begin_light();
    finish_light(bytes);
  }
  void begin_light() {
    light->result.reset();
    order_light();
    controller.lights().work();
  }
  void finish_light(const std::string& bytes) {
    EXPECT_TRUE(write_file_atomically(light->file, bytes));
    light->result = Status(Done{});
    controller.lights().work();
    std::filesystem::remove(light->file);
  }
  wire::NodeReport next() {
    const auto item = link->pop(SteadyClock().now());
    return item ? std::get<wire::NodeReport>(*item) : wire::NodeReport();
  }
  wire::NodeCommand block(const std::string& version = "") {
    wire::NodeCommand command;
    wire::RenderBlock& render = *command.mutable_render();
    render.set_block(++blocks);
    render.set_session(1);
    render.set_scene("grotto");
    render.set_width_px(512);
    render.set_height_px(256);
    wire::View& view = *render.mutable_view();
    view.set_number(1);
    view.set_samples(1);
    view.set_jpeg_quality(90);
    view.set_stored_light(!version.empty());
    view.set_light(version);
    view.mutable_panorama()->set_width_px(512);
    view.mutable_panorama()->set_height_px(256);
    view.mutable_panorama()->set_azimuth_span_rad(2.0);
    view.mutable_panorama()->set_tan_elevation_top(0.5);
    view.mutable_panorama()->set_tan_elevation_bottom(-0.5);
    return command;
  }
  /// Renders what is queued and returns the last block's error.
  std::string rendered() {
    while (controller.renders().work()) {
    }
    std::string error = "no block ended";
    while (const auto item = link->pop(SteadyClock().now())) {
      if (const auto* const end = std::get_if<RenderedBlock>(&*item)) error = end->error;
    }
    return error;
  }

  std::shared_ptr<FakeRendering> rendering = std::make_shared<FakeRendering>();
  std::shared_ptr<FakeLight> light = std::make_shared<FakeLight>();
  NodeController controller{fake_loader(rendering), 0, {cache(), 0}, fake_light_starter(light)};
  std::shared_ptr<NodeLink> link = controller.open();
  std::uint64_t blocks = 0;
};

TEST_F(NodeLight, is_computed_on_command_and_then_reported_under_its_version) {
  EXPECT_TRUE(load().can_compute_light());
  EXPECT_FALSE(controller.lights().work()) << "not before the command";
  order_light();
  ASSERT_TRUE(controller.lights().work());
  light->done_share = 0.5;
  controller.lights().work();
  EXPECT_EQ(controller.status().status().light(0).scene(), "grotto");
  EXPECT_EQ(controller.status().status().light(0).done_share(), 0.5);
  compute("light");
  const wire::SceneLight report = next().scene_light();
  EXPECT_EQ(report.scene(), "grotto");
  EXPECT_EQ(report.error(), "");
  EXPECT_EQ(report.light().version(), version_named("light"));
  EXPECT_EQ(report.light().bytes(), 5u);
  EXPECT_EQ(controller.status().status().light_size(), 0);
}

TEST_F(NodeLight, pauses_as_soon_as_a_block_arrives) {
  load();
  order_light();
  controller.lights().work();
  ASSERT_TRUE(controller.take(link, block()));
  EXPECT_TRUE(light->is_paused);
  controller.lights().work();
  EXPECT_TRUE(light->is_paused);
}

TEST_F(NodeLight, of_a_block_is_the_version_that_it_names_even_when_another_comes_meanwhile) {
  load();
  compute("first");
  const std::string first = next().scene_light().light().version();
  begin_light();
  ASSERT_TRUE(controller.take(link, block(first)));
  ASSERT_TRUE(controller.renders().work()) << "the first of two tiles";
  finish_light("second");
  ASSERT_TRUE(controller.renders().work()) << "the second";
  EXPECT_EQ(rendering->used_light(), first);
  EXPECT_EQ(rendered(), "");
  ASSERT_TRUE(controller.take(link, block(version_named("second"))));
  EXPECT_EQ(rendered(), "");
  EXPECT_EQ(rendering->used_light(), version_named("second"));
  ASSERT_TRUE(controller.take(link, block(first)));
  EXPECT_EQ(rendered(), "") << "pictures at rest keep the version before";
  ASSERT_TRUE(controller.take(link, block(version_named("third"))));
  EXPECT_THAT(rendered(), HasSubstr("has no light of version"));
}

TEST_F(NodeLight, that_a_block_reads_must_have_a_version) {
  load();
  wire::NodeCommand command = block();
  command.mutable_render()->mutable_view()->set_stored_light(true);
  ASSERT_TRUE(controller.take(link, command));
  EXPECT_THAT(rendered(), HasSubstr("view.light is empty"));
}

TEST_F(NodeLight, that_cannot_be_computed_is_told_and_the_scene_stays) {
  load();
  order_light();
  controller.lights().work();
  light->result = Status(Error(ErrorCode::kSystem, "writing 'x': its disk is full"));
  controller.lights().work();
  const wire::SceneLight report = next().scene_light();
  EXPECT_THAT(report.error(), HasSubstr("its disk is full"));
  EXPECT_FALSE(report.has_light());
  ASSERT_TRUE(controller.take(link, block()));
  EXPECT_EQ(rendered(), "");
  EXPECT_FALSE(controller.lights().work()) << "not tried again by itself";
}

TEST_F(NodeLight, of_a_damaged_file_is_told_and_computed_anew) {
  rendering->refuses_light = true;
  const std::filesystem::path file = *LightFiles(cache()).prepare("damaged");
  ASSERT_TRUE(write_file_atomically(file, std::string_view("damaged")));
  const wire::SceneLoaded loaded = load("damaged");
  EXPECT_THAT(loaded.note(), HasSubstr("the file is damaged"));
  EXPECT_TRUE(loaded.can_compute_light());
  EXPECT_FALSE(loaded.has_light());
  order_light();
  controller.lights().work();
  EXPECT_THAT(light->begun, ElementsAre("damaged"));
  EXPECT_EQ(light->file, file);
  std::filesystem::remove(file);
}

TEST_F(NodeLight, is_read_from_the_cache_when_the_scene_is_loaded_again) {
  const std::filesystem::path file = *LightFiles(cache()).prepare("kept");
  ASSERT_TRUE(write_file_atomically(file, std::string_view("light")));
  EXPECT_EQ(load("kept").light().version(), version_named("light"));
  EXPECT_FALSE(controller.lights().work());
  std::filesystem::remove(file);
}

TEST_F(NodeLight, of_a_scene_that_is_not_loaded_is_not_computed) {
  order_light();
  EXPECT_FALSE(controller.lights().work());
}

}  // namespace
}  // namespace cyclorama::node
