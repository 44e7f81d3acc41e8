// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "common/image/cells.h"
#include "common/image/inverse_depth.h"
#include "renderfarm/node/block_renderer.h"
#include "tests/doubles/fake_scene.h"

namespace cyclorama {

/// State that all renderers of a fake node share, with which a test holds them and counts their work. Thread-safe.
class FakeRendering {
 public:
  /// Opens or closes the gate. While it is closed, every rendering waits at its first cell until it is opened or
  /// cancelled.
  void set_gate(bool open) {
    {
      const std::lock_guard lock(mutex_);
      gate_open_ = open;
    }
    changed_.notify_all();
  }
  /// Closes the gate once this many more rects are rendered.
  void close_gate_after(int rects) {
    const std::lock_guard lock(mutex_);
    rects_left_ = rects;
  }
  bool pass_gate(const std::function<bool()>& cancelled) {
    std::unique_lock lock(mutex_);
    while (!gate_open_ || rects_left_ == 0) {
      if (cancelled()) return false;
      changed_.wait_for(lock, std::chrono::milliseconds(5));
    }
    if (rects_left_ > 0) --rects_left_;
    return true;
  }
  /// Sets a function that the rendering thread calls before each cell of a film; null for none.
  void set_before_cell(std::function<void()> call) {
    const std::lock_guard lock(mutex_);
    before_cell_ = std::move(call);
  }
  void before_cell() {
    std::function<void()> call;
    {
      const std::lock_guard lock(mutex_);
      call = before_cell_;
    }
    if (call) call();
  }
  void set_used_light(const std::string& version) {
    const std::lock_guard lock(mutex_);
    used_light_ = version;
  }
  /// Returns the version of the light that pictures used last; empty if none did.
  [[nodiscard]] std::string used_light() {
    const std::lock_guard lock(mutex_);
    return used_light_;
  }
  std::atomic<int> renders = 0;
  std::atomic<int> samples = 0;              ///< Total samples of all films, except denoised ones.
  std::atomic<int> film_cells = 0;           ///< Number of rendered cells of films, counting repetitions.
  std::atomic<bool> lacks_memory = false;    ///< True if every rendering throws std::bad_alloc.
  std::atomic<bool> can_have_light = false;  ///< True if the light of scenes can be computed ahead.
  std::atomic<bool> refuses_light = false;   ///< True if every file of light is rejected as damaged.

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::function<void()> before_cell_;
  std::string used_light_;
  bool gate_open_ = true;
  int rects_left_ = -1;
};

/// Returns the depth that every fake renderer gives to these cells of a picture. Neighbouring cells differ.
inline InverseDepthImage fake_depth(const PixelRect& cells) {
  InverseDepthImage depth(cells.width, cells.height);
  for (int y = 0; y < cells.height; ++y) {
    for (int x = 0; x < cells.width; ++x) {
      *depth.at(x, y) = static_cast<std::uint16_t>((5 * (cells.x + x) + 997 * (cells.y + y)) % (kMaxInverseDepth + 1));
    }
  }
  return depth;
}

/// Renders a pattern that depends only on the pixel, its samples and every field of the view.
class FakeBlockRenderer final : public node::BlockRenderer {
 public:
  explicit FakeBlockRenderer(std::shared_ptr<FakeRendering> shared, std::uint64_t memory_bytes = 1000)
      : shared_(std::move(shared)), memory_bytes_(memory_bytes) {}

  /// Renders the negative of the pattern.
  [[nodiscard]] std::unique_ptr<node::DenoisedWork> begin_denoised(const render::PanoramaView& view,
                                                                   const PixelRect& rect) override {
    if (shared_->lacks_memory) throw std::bad_alloc();
    return std::make_unique<Negative>(*this, view, rect);
  }
  /// Renders a different pattern for every range, in inexact sums. Checks for cancellation before each cell, as the
  /// real renderer does.
  render::RenderCost render_film(const render::PanoramaView& view, const PixelRect& rect,
                                 const governor::SampleRange& samples, render::Film* film,
                                 const std::function<bool()>& cancelled) override {
    return add_to_film(view, rect, samples, film, cancelled, true);
  }
  [[nodiscard]] RgbImage developed(const RadianceImage& mean) const override {
    RgbImage picture(mean.width(), mean.height());
    std::ranges::transform(mean.data(), picture.data().begin(),
                           [](float value) { return static_cast<std::uint8_t>(255.0f * value + 0.5f); });
    return picture;
  }
  [[nodiscard]] wire::SceneDescription description() const override { return fake_scene(""); }
  [[nodiscard]] bool can_have_light() const override { return shared_->can_have_light; }
  /// Accepts any bytes as light.
  Result<node::VersionedLight> add_light(std::span<const std::byte> file, std::string_view name) override {
    if (shared_->refuses_light) return Error(ErrorCode::kBadData, std::string(name) + ": the file is damaged");
    node::VersionedLight light{node::version_of(file), file.size(), std::make_shared<light::LightStore>()};
    lights_.add(light);
    const std::lock_guard lock(mutex_);
    versions_[light.store.get()] = light;
    return light;
  }
  [[nodiscard]] const node::LightVersions* light_versions() const override { return &lights_; }
  [[nodiscard]] std::string note() const override { return {}; }
  [[nodiscard]] std::uint64_t memory_bytes() const override { return memory_bytes_; }
  [[nodiscard]] int bounces() const override { return 4; }
  [[nodiscard]] double probe_cpu_seconds() override { return 0.25; }

  /// Reported cost of one sample of each pixel of a cell. It is similar to a ray tracer's, so that using more nodes is
  /// worth their overhead.
  static constexpr float kCellSeconds = 0x1p-15f;

 private:
  class Negative final : public node::DenoisedWork {
   public:
    Negative(FakeBlockRenderer& of, render::PanoramaView view, const PixelRect& rect)
        : of_(of), view_(std::move(view)), rect_(rect), film_(rect.width, rect.height, false) {}
    render::RenderCost advance(const std::function<bool()>& stop, RadianceImage* ret_light,
                               InverseDepthImage* ret_depth) override {
      render::RenderCost cost = of_.add_to_film(view_, rect_, {0, 1}, &film_, stop, false);
      if (std::ranges::find(film_.samples.data(), 0) != film_.samples.data().end()) return cost;
      *ret_light = film_.mean();
      *ret_depth = view_.depth ? fake_depth(depth_cells(rect_)) : InverseDepthImage();
      for (float& value : ret_light->data()) value = 1.0f - value;
      return cost;
    }

   private:
    FakeBlockRenderer& of_;
    const render::PanoramaView view_;
    const PixelRect rect_;
    render::Film film_;
  };
  render::RenderCost add_to_film(const render::PanoramaView& view, const PixelRect& rect,
                                 const governor::SampleRange& samples, render::Film* film,
                                 const std::function<bool()>& cancelled, bool counts_samples) {
    render::PanoramaView one = view;
    one.quality.samples = 1;
    const PixelRect cells = cells_touched(rect);
    std::vector<float> seconds(static_cast<std::size_t>(cells.area()));
    if (shared_->lacks_memory) throw std::bad_alloc();
    if (view.light != nullptr) {
      const std::lock_guard lock(mutex_);
      shared_->set_used_light(versions_.at(view.light.get()).version);
    }
    if (!film->depth.empty()) film->depth = fake_depth(depth_cells(rect));
    if (!shared_->pass_gate(cancelled)) return cost_of(rect, seconds);
    bool stopped = false;
    for (int row = cells.y; row < cells.y + cells.height; ++row) {
      for (int column = cells.x; column < cells.x + cells.width; ++column) {
        const PixelRect cell{column * kCostCellPx, row * kCostCellPx, kCostCellPx, kCostCellPx};
        if (*film->samples.at(std::max(cell.x, rect.x) - rect.x, std::max(cell.y, rect.y) - rect.y) > 0) continue;
        shared_->before_cell();
        stopped = stopped || (cancelled && cancelled());
        if (stopped) continue;
        add_samples(one, rect, cell, samples, film);
        seconds[cell_index(cells, column, row)] = kCellSeconds * static_cast<float>(samples.end - samples.first);
        ++shared_->film_cells;
      }
    }
    if (!stopped) ++shared_->renders;
    if (!stopped && counts_samples) shared_->samples += samples.end - samples.first;
    return cost_of(rect, seconds);
  }
  static render::RenderCost cost_of(const PixelRect& rect, std::vector<float> seconds) {
    render::RenderCost cost;
    cost.rays = static_cast<std::uint64_t>(rect.area());
    for (const float cell : seconds) cost.cpu_seconds += static_cast<double>(cell);
    cost.wall_seconds = cost.cpu_seconds;
    cost.cell_cpu_seconds = std::move(seconds);
    return cost;
  }
  static void add_samples(const render::PanoramaView& view, const PixelRect& rect, const PixelRect& cell,
                          const governor::SampleRange& samples, render::Film* film) {
    for (int y = std::max(cell.y, rect.y); y < std::min(cell.y + cell.height, rect.y + rect.height); ++y) {
      for (int x = std::max(cell.x, rect.x); x < std::min(cell.x + cell.width, rect.x + rect.width); ++x) {
        for (int sample = samples.first; sample < samples.end; ++sample) {
          std::uint8_t rgb[3];
          colour(view, x + 37 * sample, y + 11 * sample, rgb);
          float* const sum = film->sum.at(x - rect.x, y - rect.y);
          for (int c = 0; c < 3; ++c) sum[c] += static_cast<float>(rgb[c]) / 255.0f;
          ++*film->samples.at(x - rect.x, y - rect.y);
        }
      }
    }
  }
  static void colour(const render::PanoramaView& view, int x, int y, std::uint8_t* ret_rgb) {
    const int turn = static_cast<int>(view.heading_rad * 100.0 + view.eye.sum() * 10.0) + view.quality.samples +
                     (view.quality.stored_light ? 50 : 0);
    ret_rgb[0] = static_cast<std::uint8_t>(x / 2 + turn);
    ret_rgb[1] = static_cast<std::uint8_t>(y + static_cast<int>(view.seed) * 7);
    ret_rgb[2] = static_cast<std::uint8_t>((x * y) / 64);
  }
  const std::shared_ptr<FakeRendering> shared_;
  const std::uint64_t memory_bytes_;
  node::LightVersions lights_;
  std::mutex mutex_;                                                   ///< Guards the following.
  std::map<const light::LightStore*, node::VersionedLight> versions_;  ///< All that were added, kept alive.
};

/// Loads every scene except those named "missing" or "huge".
inline node::SceneLoader fake_loader(std::shared_ptr<FakeRendering> shared = std::make_shared<FakeRendering>()) {
  return [shared](const std::string& path,
                  const std::function<void(double)>& progress) -> Result<std::unique_ptr<node::BlockRenderer>> {
    progress(0.5);
    if (path == "missing") return Error(ErrorCode::kNotFound, "no such file: 'missing'");
    if (path == "huge") throw std::bad_alloc();
    return std::unique_ptr<node::BlockRenderer>(std::make_unique<FakeBlockRenderer>(shared));
  };
}

}  // namespace cyclorama
