// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/renderer.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <time.h>

#include <atomic>
#include <cmath>

#include "common/base/check.h"
#include "common/base/clock.h"
#include "common/image/colour.h"
#include "renderfarm/render/accelerator.h"
#include "renderfarm/render/bake.h"
#include "renderfarm/render/flush_denormals.h"
#include "renderfarm/render/kernel.h"
#include "renderfarm/render/tone.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama {
namespace {

constexpr int kCellPx = 16;

double thread_cpu_seconds() {
  timespec t{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Where a finished cell goes.
using Write = std::function<void(const TraceCell& cell)>;

}  // namespace

struct Renderer::State {
  Scene scene;
  TraceScene traced;
  std::unique_ptr<Accelerator> accelerator;
  Kernel kernel = nullptr;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  double build_seconds = 0.0;
  mutable tbb::task_arena arena;

  RenderCost run(const PanoramaView& view, const PixelRect& rect, const std::function<bool()>& cancelled,
                 const Write& write) const;
};

Status check_view(const PanoramaView& view, const PixelRect& rect) {
  const Projection picture = view.picture();
  TRY(picture.validate());
  const auto refuse = [](std::string what) { return Error(ErrorCode::kInvalidArgument, std::move(what)); };
  if (!view.eye.allFinite()) return refuse("the eye's place is not finite");
  if (!std::isfinite(view.heading_rad)) return refuse("the heading is not finite");
  if (view.samples < 1 || view.samples > kMostSamples) {
    return refuse(fmt::format("{} samples per pixel are asked for; it must be 1 to {}", view.samples, kMostSamples));
  }
  const bool inside = rect.x >= 0 && rect.y >= 0 && rect.width >= 0 && rect.height >= 0 &&
                      rect.width <= picture.width_px() - rect.x && rect.height <= picture.height_px() - rect.y;
  if (inside) return Done{};
  return refuse(fmt::format("the rectangle {}x{} at ({}, {}) is not inside the {}x{} picture", rect.width, rect.height,
                            rect.x, rect.y, picture.width_px(), picture.height_px()));
}

Renderer::Renderer(std::unique_ptr<State> state) : state_(std::move(state)) {}
Renderer::~Renderer() = default;

Result<std::unique_ptr<Renderer>> Renderer::build(Scene scene, int threads,
                                                  const std::function<void(double)>& progress) {
  const SteadyClock clock;
  const TimePoint start = clock.now();
  auto state = std::make_unique<State>();
  state->scene = std::move(scene);
  Scene& held = state->scene;
  state->arena.initialize(threads > 0 ? threads : tbb::task_arena::automatic);
  state->origin = render_origin(held);
  state->kernel = kernel_for(needs_of(held));
  TraceScene& traced = state->traced;
  TRY_ASSIGN(state->accelerator, Accelerator::build(held, threads, progress, &traced));
  traced.lamps = make_lamps(held.model.lights, state->origin);
  traced.sky = held.sky;
  traced.ambient = held.ambient;
  traced.eye_lamp = held.eye_lamp;
  state->build_seconds = to_seconds(clock.now() - start);
  return std::unique_ptr<Renderer>(new Renderer(std::move(state)));
}

RenderCost Renderer::State::run(const PanoramaView& view, const PixelRect& rect, const std::function<bool()>& cancelled,
                                const Write& write) const {
  CHECK(check_view(view, rect).has_value());
  const SteadyClock clock;
  const TimePoint start = clock.now();
  TraceView traced_view;
  traced_view.eye = (view.eye - origin).cast<float>();
  traced_view.camera = Camera(view.picture(), view.heading_rad);
  traced_view.samples = view.samples;
  traced_view.seed = view.seed;

  std::atomic<std::uint64_t> rays = 0;
  std::atomic<double> cpu_seconds = 0.0;
  const int columns = (rect.width + kCellPx - 1) / kCellPx;
  const int rows = (rect.height + kCellPx - 1) / kCellPx;
  const auto trace_one = [&](int index) {
    if (cancelled && cancelled()) return;
    const double before = thread_cpu_seconds();
    const FlushDenormals flush;
    const int x = index % columns * kCellPx;
    const int y = index / columns * kCellPx;
    std::array<float, std::size_t{3} * kCellPx * kCellPx> radiance;
    const TraceCell cell{rect.x + x,
                         rect.y + y,
                         std::min(kCellPx, rect.width - x),
                         std::min(kCellPx, rect.height - y),
                         radiance.data(),
                         std::size_t{3} * kCellPx};
    rays += kernel(traced, traced_view, cell);
    write(cell);
    cpu_seconds += thread_cpu_seconds() - before;
  };
  const int cells = columns * rows;
  if (cells == 1) {
    trace_one(0);
  } else {
    arena.execute([&] { tbb::parallel_for(0, cells, trace_one, tbb::simple_partitioner()); });
  }
  return {cpu_seconds.load(), to_seconds(clock.now() - start), rays.load()};
}

RenderCost Renderer::render(const PanoramaView& view, const PixelRect& rect, RgbImage* ret_pixels,
                            const std::function<bool()>& cancelled) const {
  *ret_pixels = RgbImage(rect.width, rect.height);
  const auto exposure = static_cast<float>(state_->scene.exposure);
  return state_->run(view, rect, cancelled, [&](const TraceCell& cell) {
    for (int row = 0; row < cell.height; ++row) {
      const float* in = cell.radiance + static_cast<std::size_t>(row) * cell.stride;
      std::uint8_t* out = ret_pixels->at(cell.x - rect.x, cell.y - rect.y + row);
      for (int i = 0; i < 3 * cell.width; ++i) out[i] = linear_to_srgb8(tone_mapped(exposure * in[i]));
    }
  });
}

RenderCost Renderer::render_radiance(const PanoramaView& view, const PixelRect& rect, RadianceImage* ret_pixels,
                                     const std::function<bool()>& cancelled) const {
  *ret_pixels = RadianceImage(rect.width, rect.height);
  const auto exposure = static_cast<float>(state_->scene.exposure);
  return state_->run(view, rect, cancelled, [&](const TraceCell& cell) {
    for (int row = 0; row < cell.height; ++row) {
      const float* in = cell.radiance + static_cast<std::size_t>(row) * cell.stride;
      float* out = ret_pixels->at(cell.x - rect.x, cell.y - rect.y + row);
      for (int i = 0; i < 3 * cell.width; ++i) out[i] = exposure * in[i];
    }
  });
}

const Scene& Renderer::scene() const { return state_->scene; }
double Renderer::build_seconds() const { return state_->build_seconds; }
std::size_t Renderer::bvh_bytes() const { return state_->accelerator->bytes(); }

}  // namespace cyclorama
