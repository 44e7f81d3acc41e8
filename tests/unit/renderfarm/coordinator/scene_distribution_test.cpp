// SPDX-License-Identifier: Apache-2.0
// A coordinator that distributes a scene, nodes with empty caches, and the real ray tracer.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <mutex>

#include "renderfarm/client/farm_client.h"
#include "renderfarm/coordinator/coordinator.h"
#include "renderfarm/node/embree_block_renderer.h"
#include "renderfarm/node/farm_node.h"
#include "renderfarm/node/light_program.h"
#include "tests/data_sets/scene_folder.h"
#include "tests/doubles/recording_farm_listener.h"

namespace cyclorama::coordinator {
namespace {

namespace fs = std::filesystem;

constexpr const char* kScene =
    "title = \"A tent\"\n[start]\neye_m = [0, 1.6, 0]\n[sky]\nzenith = [1, 1, 1]\nhorizon = [0.5, 0.4, 0.3]\n"
    "ground = [0, 0, 0]\n[visitor]\nwalkable_m = [[-1, -1], [1, -1], [1, 1], [-1, 1]]\n"
    "[[geometry]]\nfile = \"parts/tent.ply\"\n";
/// A floor and a slope.
constexpr const char* kTent =
    "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
    "-4 0 -4\n-4 0 4\n4 0 4\n4 0 -4\n-4 3 -4\n4 3 -4\n4 0 1 2 3\n4 0 3 5 4\n";

wire::View a_view() {
  wire::View view;
  view.set_number(1);
  view.set_samples(4);
  view.set_jpeg_quality(90);
  view.mutable_eye_m()->set_y(1.6);
  view.mutable_panorama()->set_width_px(320);
  view.mutable_panorama()->set_height_px(160);
  view.mutable_panorama()->set_azimuth_span_rad(1.5);
  view.mutable_panorama()->set_tan_elevation_top(0.4);
  view.mutable_panorama()->set_tan_elevation_bottom(-0.4);
  return view;
}

class SceneDistributionTest : public testing::Test {
 protected:
  void SetUp() override {
    write_bytes(folder / "scene.toml", kScene);
    write_bytes(folder / "parts/tent.ply", kTent);
  }
  void start_coordinator(bool on_coordinator) {
    CoordinatorOptions options;
    options.scenes = {{"tent", folder.string(), on_coordinator}};
    options.museums = options.nodes = "[::1]:0";
    options.limits.light_gathering = Duration::zero();
    auto started = Coordinator::start(options, [this](const std::string& sentence, const NoticeAbout&) {
      const std::lock_guard lock(mutex);
      notices.push_back(sentence);
      noticed.notify_all();
    });
    ASSERT_TRUE(started) << started.error().message();
    coordinator = *std::move(started);
  }
  /// Waits until the coordinator gives a notice that contains these words.
  [[nodiscard]] bool wait_for_notice(const std::string& words) {
    std::unique_lock lock(mutex);
    return noticed.wait_for(lock, std::chrono::seconds(8), [&] {
      return std::ranges::any_of(notices, [&](const std::string& notice) { return notice.find(words) != notice.npos; });
    });
  }
  [[nodiscard]] std::unique_ptr<node::FarmNode> add_node(const std::string& cache,
                                                         const node::LightStarter& light = nullptr) const {
    node::FarmNodeOptions options{.coordinators = {"[::1]:" + std::to_string(coordinator->node_port())}, .name = cache};
    options.cache = {temporary.path() / cache, 0};
    auto started = node::FarmNode::start(options, node::embree_scene_loader(std::make_shared<render::Crew>(1)), light);
    EXPECT_TRUE(started);
    return *std::move(started);
  }
  /// Returns the tiles' bytes by position.
  [[nodiscard]] std::map<std::pair<std::uint32_t, std::uint32_t>, std::string> picture() const {
    RecordingFarmListener listener;
    const auto client = client::FarmClient::start(
        {.coordinators = {"[::1]:" + std::to_string(coordinator->museum_port())}, .museum = "test"}, listener);
    EXPECT_TRUE(client);
    EXPECT_TRUE(listener.wait([](const auto& seen) { return seen.opened > 0; }))
        << testing::PrintToString(listener.seen().reasons);
    (*client)->request(a_view());
    EXPECT_TRUE(listener.wait([](const auto& seen) { return !seen.frames.empty(); }));
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::string> tiles;
    const auto seen = listener.seen();
    if (seen.frames.empty() || !seen.frames.front().end.complete()) return tiles;
    for (const wire::Tile& tile : seen.frames.front().tiles) tiles[{tile.x_px(), tile.y_px()}] = tile.jpeg();
    (*client)->stop();
    return tiles;
  }

  TemporaryFolder temporary;
  const fs::path folder = temporary.path() / "scene";
  std::mutex mutex;  ///< Guards the following.
  std::condition_variable noticed;
  std::vector<std::string> notices;
  std::unique_ptr<Coordinator> coordinator;
};

/// Light that was computed when it began.
class ComputedLight final : public node::LightComputation {
 public:
  explicit ComputedLight(Status result) : result_(std::move(result)) {}
  void pause() override {}
  void resume() override {}
  void compute(std::uint32_t, std::uint32_t) override {}
  void fetched(std::uint32_t, std::uint32_t) override {}
  [[nodiscard]] std::vector<node::LightEvent> events() override { return {}; }
  [[nodiscard]] double done_share() override { return 1.0; }
  [[nodiscard]] std::optional<Status> result() override { return result_; }

 private:
  const Status result_;
};

TEST_F(SceneDistributionTest, brings_a_scene_to_an_empty_node_that_renders_the_same_picture) {
  start_coordinator(false);
  auto node = add_node("unused");
  const auto from_disk = picture();
  EXPECT_FALSE(from_disk.empty());
  node.reset();
  coordinator.reset();
  start_coordinator(true);
  node = add_node("cache");
  EXPECT_EQ(picture(), from_disk);
  EXPECT_EQ(coordinator->sent_file_bytes(), std::string(kScene).size() + std::string(kTent).size());
  EXPECT_FALSE(fs::exists(temporary.path() / "unused"));
}

TEST_F(SceneDistributionTest, reloads_a_scene_that_was_changed_while_the_coordinator_was_away) {
  start_coordinator(true);
  auto node = add_node("cache");
  const auto before = picture();
  node.reset();
  coordinator.reset();
  std::string darker = kScene;
  darker.replace(darker.find("zenith = [1, 1, 1]"), 18, "zenith = [0, 0, 1]");
  write_bytes(folder / "scene.toml", darker);
  start_coordinator(true);
  node = add_node("cache");
  EXPECT_NE(picture(), before);
  EXPECT_EQ(coordinator->sent_file_bytes(), darker.size());  // The tent's own file was in the cache.
}

TEST_F(SceneDistributionTest, has_light_computed_by_one_node_and_gives_it_to_the_others) {
  std::atomic<int> computations = 0;
  const node::LightStarter starter = [&](const fs::path& scene,
                                         const fs::path& file) -> Result<std::unique_ptr<node::LightComputation>> {
    ++computations;
    return std::unique_ptr<node::LightComputation>(
        std::make_unique<ComputedLight>(node::compute_light(scene, file, 1, [](double) {})));
  };
  start_coordinator(true);
  auto second = add_node("second");
  ASSERT_TRUE(wait_for_notice("node 'second' has scene 'tent'"));
  auto first = add_node("first", starter);
  ASSERT_TRUE(wait_for_notice("has its light computed")) << "it is not used before both have it";
  EXPECT_EQ(computations, 1);
  EXPECT_FALSE(picture().empty());
  // A restarted coordinator learns of the light from the nodes that have kept it.
  second.reset();
  first.reset();
  coordinator.reset();
  notices.clear();
  start_coordinator(true);
  second = add_node("second", starter);
  ASSERT_TRUE(wait_for_notice("has its light computed"));
  EXPECT_EQ(computations, 1);
}

}  // namespace
}  // namespace cyclorama::coordinator
