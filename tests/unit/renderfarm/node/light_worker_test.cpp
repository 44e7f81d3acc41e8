// SPDX-License-Identifier: Apache-2.0
// Light computed in a node's idle time, without a process: the worker alone, then within a node.
#include "renderfarm/node/light_worker.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

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
  std::vector<std::string> finished;
  LightWorker worker{fake_light_starter(light),
                     LightFiles(cache()),
                     {[this] { return has_blocks; },
                      [this](const std::string& path, const std::filesystem::path&, const Status& status) {
                        finished.push_back(path + (status ? "" : ": " + status.error().message()));
                      }},
                     clock};
};

TEST_F(LightWorkerTest, computes_one_scene_after_the_other_and_each_once) {
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
  worker.want("a", "grotto");
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

TEST_F(LightWorkerTest, ends_the_computation_when_the_node_stops) {
  worker.want("a", "grotto");
  worker.work();
  worker.stop();
  EXPECT_FALSE(worker.wait());
  EXPECT_TRUE(light->is_ended);
  EXPECT_THAT(finished, ElementsAre());
}

TEST_F(LightWorkerTest, reports_why_nothing_can_be_written) {
  LightWorker homeless(
      fake_light_starter(light), LightFiles(""),
      {[] { return false; }, [this](const std::string&, const std::filesystem::path&,
                                    const Status& status) { finished.push_back(status.error().message()); }},
      clock);
  homeless.want("scene.ply", "grotto");
  homeless.work();
  EXPECT_THAT(finished, ElementsAre(HasSubstr("give the node a cache")));
  EXPECT_FALSE(homeless.work());
}

class NodeLight : public testing::Test {
 protected:
  NodeLight() { rendering->wants_light = true; }
  /// Returns the reply to the load of a scene.
  wire::SceneLoaded load(const std::string& path = "a") {
    wire::NodeCommand command;
    command.mutable_load_scene()->set_scene("grotto");
    command.mutable_load_scene()->set_path(path);
    EXPECT_TRUE(controller.take(link, command));
    EXPECT_TRUE(controller.loads().work());
    return next();
  }
  wire::SceneLoaded next() {
    const auto item = link->pop(SteadyClock().now());
    return item ? std::get<wire::NodeReport>(*item).scene_loaded() : wire::SceneLoaded();
  }
  wire::NodeCommand block() {
    wire::NodeCommand command;
    wire::RenderBlock& render = *command.mutable_render();
    render.set_block(1);
    render.set_session(1);
    render.set_scene("grotto");
    render.set_width_px(512);
    render.set_height_px(256);
    wire::View& view = *render.mutable_view();
    view.set_number(1);
    view.set_samples(1);
    view.set_jpeg_quality(90);
    view.mutable_panorama()->set_width_px(512);
    view.mutable_panorama()->set_height_px(256);
    view.mutable_panorama()->set_azimuth_span_rad(2.0);
    view.mutable_panorama()->set_tan_elevation_top(0.5);
    view.mutable_panorama()->set_tan_elevation_bottom(-0.5);
    return command;
  }

  std::shared_ptr<FakeRendering> rendering = std::make_shared<FakeRendering>();
  std::shared_ptr<FakeLight> light = std::make_shared<FakeLight>();
  NodeController controller{fake_loader(rendering), 0, {cache(), 0}, fake_light_starter(light)};
  std::shared_ptr<NodeLink> link = controller.open();
};

TEST_F(NodeLight, is_computed_while_idle_and_then_described_to_the_coordinator) {
  EXPECT_EQ(load().front(), "");
  ASSERT_TRUE(controller.lights().work());
  light->done_share = 0.5;
  controller.lights().work();
  EXPECT_EQ(controller.status().status().light(0).scene(), "grotto");
  EXPECT_EQ(controller.status().status().light(0).done_share(), 0.5);
  light->result = Status(Done{});
  controller.lights().work();
  EXPECT_EQ(next().scene(), "") << "it is the rendering thread that switches";
  controller.renders().work();
  const wire::SceneLoaded again = next();
  EXPECT_EQ(again.scene(), "grotto");
  EXPECT_THAT(again.front(), HasSubstr("stored_light = true"));
  EXPECT_EQ(again.note(), "");
  EXPECT_EQ(controller.status().status().light_size(), 0);
}

TEST_F(NodeLight, pauses_as_soon_as_a_block_arrives) {
  load();
  controller.lights().work();
  ASSERT_TRUE(controller.take(link, block()));
  EXPECT_TRUE(light->is_paused);
  controller.lights().work();
  EXPECT_TRUE(light->is_paused);
}

TEST_F(NodeLight, is_not_switched_in_the_middle_of_a_block) {
  load();
  controller.lights().work();
  ASSERT_TRUE(controller.take(link, block()));
  ASSERT_TRUE(controller.renders().work()) << "the first of two tiles";
  light->result = Status(Done{});
  controller.lights().work();
  ASSERT_TRUE(controller.renders().work()) << "the second";
  std::vector<bool> is_report;
  while (controller.renders().work() || is_report.size() < 4) {
    const auto item = link->pop(SteadyClock().now());
    if (!item) break;
    is_report.push_back(std::holds_alternative<wire::NodeReport>(*item));
  }
  EXPECT_THAT(is_report, ElementsAre(false, false, false, true)) << "two tiles, the end, the new description";
}

TEST_F(NodeLight, that_cannot_be_computed_is_told_once_and_the_scene_stays) {
  load();
  controller.lights().work();
  light->result = Status(Error(ErrorCode::kSystem, "writing 'x': its disk is full"));
  controller.lights().work();
  controller.renders().work();
  const wire::SceneLoaded again = next();
  EXPECT_EQ(again.error(), "");
  EXPECT_EQ(again.front(), "");
  EXPECT_THAT(again.note(), HasSubstr("its disk is full"));
  EXPECT_EQ(load().error(), "");
  EXPECT_FALSE(controller.lights().work()) << "not tried again";
}

TEST_F(NodeLight, of_a_damaged_file_is_told_and_computed_anew) {
  rendering->refuses_light = true;
  const std::filesystem::path file = *LightFiles(cache()).prepare("damaged");
  ASSERT_TRUE(write_file_atomically(file, std::string_view("damaged")));
  EXPECT_THAT(load("damaged").note(), HasSubstr("the file is damaged"));
  controller.lights().work();
  EXPECT_THAT(light->begun, ElementsAre("damaged"));
  EXPECT_EQ(light->file, file);
  std::filesystem::remove(file);
}

TEST_F(NodeLight, is_read_from_the_cache_when_the_scene_is_loaded_again) {
  const std::filesystem::path file = *LightFiles(cache()).prepare("kept");
  ASSERT_TRUE(write_file_atomically(file, std::string_view("light")));
  EXPECT_THAT(load("kept").front(), HasSubstr("stored_light = true"));
  EXPECT_FALSE(controller.lights().work());
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace cyclorama::node
