// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/node_threads/block_trace.h"

#include <cmath>
#include <memory>
#include <numeric>
#include <utility>

#include "common/base/cpu_time.h"
#include "renderfarm/node/block_work.h"
#include "renderfarm/node/embree_block_renderer.h"
#include "renderfarm/node/tile_sender.h"
#include "renderfarm/render/crew.h"

namespace cyclorama {
namespace {

/// Computes everything on the calling thread and notes how long it took, in thread time, so that other load on this
/// machine does not count.
class RecordingCrew final : public render::Crew {
 public:
  explicit RecordingCrew(int threads) : Crew(WithoutThreads{}, threads) {}

  void run(int count, const std::function<void(int)>& work) override {
    BlockTrace::Step& step = steps_.emplace_back();
    step.serial_seconds = thread_cpu_seconds() - since_;
    for (int cell = 0; cell < count; ++cell) {
      const double before = thread_cpu_seconds();
      work(cell);
      step.cells.push_back(static_cast<float>(thread_cpu_seconds() - before));
    }
    since_ = thread_cpu_seconds();
  }
  void begin() {
    steps_.clear();
    since_ = thread_cpu_seconds();
  }
  [[nodiscard]] std::vector<BlockTrace::Step> take() { return std::exchange(steps_, {}); }
  [[nodiscard]] double seconds_since_step() const { return thread_cpu_seconds() - since_; }

 private:
  std::vector<BlockTrace::Step> steps_;
  double since_ = 0.0;
};

wire::RenderBlock block_of(const TracedPicture& picture, const node::BlockRenderer& renderer, int index) {
  wire::RenderBlock block;
  block.set_block(static_cast<std::uint64_t>(index) + 2);
  block.set_session(1);
  block.set_width_px(static_cast<std::uint32_t>(picture.width_px));
  block.set_height_px(static_cast<std::uint32_t>(picture.height_px));
  block.set_watermark(77);
  wire::View& view = *block.mutable_view();
  const wire::SceneDescription scene = renderer.description();
  view.set_number(block.block());
  *view.mutable_eye_m() = scene.start_eye_m();
  view.mutable_eye_m()->set_x(scene.start_eye_m().x() + 0.3 * std::sin(index));
  view.set_heading_rad(scene.start_heading_rad() + 0.7 * index);
  view.set_samples(static_cast<std::uint32_t>(picture.samples));
  view.set_bounces(static_cast<std::uint32_t>(renderer.bounces()));
  view.set_jpeg_quality(85);
  view.set_denoise(picture.denoise);
  view.set_depth(true);
  if (picture.stored_light) {
    view.set_stored_light(true);
    const auto light = renderer.light_versions()->newest();
    if (light) view.set_light(light->version);
  }
  view.mutable_panorama()->set_width_px(block.width_px());
  view.mutable_panorama()->set_height_px(block.height_px());
  view.mutable_panorama()->set_azimuth_span_rad(2.6);
  view.mutable_panorama()->set_tan_elevation_top(0.73);
  view.mutable_panorama()->set_tan_elevation_bottom(-0.73);
  return block;
}

}  // namespace

double BlockTrace::seconds() const {
  double sum = rest_seconds + std::accumulate(encoding.begin(), encoding.end(), 0.0);
  for (const Step& step : rendering)
    sum += step.serial_seconds + std::accumulate(step.cells.begin(), step.cells.end(), 0.0);
  return sum;
}

Result<std::vector<BlockTrace>> traced_blocks(const std::string& scene, const TracedPicture& picture, int views,
                                              int threads) {
  const auto crew = std::make_shared<RecordingCrew>(threads);
  TRY_ASSIGN(std::shared_ptr<node::BlockRenderer> renderer, node::embree_scene_loader(crew)(scene, [](double) {}));
  std::vector<BlockTrace> traces;
  // The first block is left out: it makes tables and touches memory that later ones find.
  for (int index = -1; index < views; ++index) {
    auto order = std::make_shared<node::BlockOrder>();
    order->renderer = renderer;
    order->block = block_of(picture, *renderer, index);
    TRY_ASSIGN(node::BlockWork work, node::BlockWork::begin(order));
    node::FilmStore films;
    BlockTrace trace;
    std::vector<node::NodeLink::Outgoing> tiles;
    crew->begin();
    while (!work.is_done()) {
      for (auto& tile : work.next_tiles(films, *crew, {[] { return false; }, [] { return false; }})) {
        tiles.emplace_back(std::move(tile));
      }
    }
    trace.rest_seconds = crew->seconds_since_step();
    trace.rendering = crew->take();
    node::TileSender(*crew).reports_of(std::move(tiles));
    trace.encoding = crew->take().front().cells;
    if (index >= 0) traces.push_back(std::move(trace));
  }
  return traces;
}

}  // namespace cyclorama
