// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>

#include "renderfarm/node/block_renderer.h"
#include "tests/doubles/fake_farm.h"

namespace cyclorama {

/// What all renderers of one fake node share, so that a test can hold them and count. Thread-safe.
class FakeRendering {
 public:
  /// Closed, every render() waits at its first cell until it is opened or cancelled.
  void set_gate(bool open) {
    {
      const std::lock_guard lock(mutex_);
      gate_open_ = open;
    }
    changed_.notify_all();
  }
  /// The gate closes by itself when this many more rectangles were rendered.
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
  std::atomic<int> renders = 0;
  std::atomic<int> samples = 0;  ///< Of all films together.

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool gate_open_ = true;
  int rects_left_ = -1;
};

/// Draws a pattern that depends on the pixel and on every field of the view, and on nothing else.
class FakeBlockRenderer final : public BlockRenderer {
 public:
  /// What it says it took: as long as a ray tracer, so that more nodes are worth their overhead.
  static constexpr double kSecondsPerSample = 1e-7;

  explicit FakeBlockRenderer(std::shared_ptr<FakeRendering> shared) : shared_(std::move(shared)) {}

  RenderCost render(const PanoramaView& view, const PixelRect& rect, RgbImage* ret_pixels,
                    const std::function<bool()>& cancelled) override {
    *ret_pixels = RgbImage(rect.width, rect.height);
    if (!shared_->pass_gate(cancelled)) return {};
    for (int y = 0; y < rect.height; ++y) {
      for (int x = 0; x < rect.width; ++x) colour(view, rect.x + x, rect.y + y, ret_pixels->at(x, y));
    }
    ++shared_->renders;
    const double seconds = kSecondsPerSample * static_cast<double>(rect.area());
    return {seconds, seconds, static_cast<std::uint64_t>(rect.area())};
  }
  /// The negative of the pattern.
  RenderCost render_denoised(const PanoramaView& view, const PixelRect& rect, RgbImage* ret_pixels,
                             const std::function<bool()>& cancelled) override {
    const RenderCost cost = render(view, rect, ret_pixels, cancelled);
    for (std::uint8_t& value : ret_pixels->data()) value = static_cast<std::uint8_t>(255 - value);
    return cost;
  }
  /// Every range has a pattern of its own, in sums that are not exact.
  RenderCost render_film(const PanoramaView& view, const PixelRect& rect, const SampleRange& samples, Film* ret_film,
                         const std::function<bool()>& cancelled) override {
    *ret_film = Film(rect.width, rect.height, false);
    PanoramaView one = view;
    one.quality.samples = 1;
    if (!shared_->pass_gate(cancelled)) return {};
    for (int sample = samples.first; sample < samples.end; ++sample) {
      for (int y = 0; y < rect.height; ++y) {
        for (int x = 0; x < rect.width; ++x) {
          std::uint8_t rgb[3];
          colour(one, rect.x + x + 37 * sample, rect.y + y + 11 * sample, rgb);
          for (int c = 0; c < 3; ++c) ret_film->sum.at(x, y)[c] += static_cast<float>(rgb[c]) / 255.0f;
          ++*ret_film->samples.at(x, y);
        }
      }
    }
    ++shared_->renders;
    shared_->samples += samples.end - samples.first;
    const double seconds = kSecondsPerSample * static_cast<double>(rect.area() * (samples.end - samples.first));
    return {seconds, seconds, static_cast<std::uint64_t>(rect.area())};
  }
  [[nodiscard]] RgbImage developed(const Film& film) const override {
    const RadianceImage mean = film.mean();
    RgbImage picture(film.width(), film.height());
    std::ranges::transform(mean.data(), picture.data().begin(),
                           [](float value) { return static_cast<std::uint8_t>(255.0f * value + 0.5f); });
    return picture;
  }
  [[nodiscard]] wire::SceneDescription description() const override { return fake_scene("unnamed"); }
  [[nodiscard]] std::uint64_t memory_bytes() const override { return 1000; }

 private:
  static void colour(const PanoramaView& view, int x, int y, std::uint8_t* ret_rgb) {
    const int turn = static_cast<int>(view.heading_rad * 100.0 + view.eye.sum() * 10.0) + view.quality.samples;
    ret_rgb[0] = static_cast<std::uint8_t>(x / 2 + turn);
    ret_rgb[1] = static_cast<std::uint8_t>(y + static_cast<int>(view.seed) * 7);
    ret_rgb[2] = static_cast<std::uint8_t>((x * y) / 64);
  }
  const std::shared_ptr<FakeRendering> shared_;
};

/// Loads everything but what is called "missing" or "huge".
inline SceneLoader fake_loader(std::shared_ptr<FakeRendering> shared = std::make_shared<FakeRendering>()) {
  return [shared](const std::string& path,
                  const std::function<void(double)>& progress) -> Result<std::unique_ptr<BlockRenderer>> {
    progress(0.5);
    if (path == "missing") return Error(ErrorCode::kNotFound, "no such file: 'missing'");
    if (path == "huge") throw std::bad_alloc();
    return std::unique_ptr<BlockRenderer>(std::make_unique<FakeBlockRenderer>(shared));
  };
}

}  // namespace cyclorama
