// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/renderer.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>

#include "common/base/check.h"
#include "common/base/clock.h"
#include "common/base/cpu_time.h"
#include "common/image/cells.h"
#include "renderfarm/light/light_file.h"
#include "renderfarm/light/scene_key.h"
#include "renderfarm/render/accelerator.h"
#include "renderfarm/render/bake.h"
#include "renderfarm/render/cell_sampling.h"
#include "renderfarm/render/crew.h"
#include "renderfarm/render/flush_denormals.h"
#include "renderfarm/render/requirements.h"
#include "renderfarm/render/tone.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama::render {
namespace {

/// The part of a cell that lies in the requested rect, in the picture's pixels.
struct CellPart {
  int left, top, right, bottom;
};

/// Destination of finished cells.
struct Output {
  std::function<void(const TraceCell& cell, const CellPart& part, const CellFilm& film)> write;
  /// Returns true if the film already has samples of this part; null if the film is new.
  std::function<bool(const CellPart& part)> has = nullptr;
  bool features = false;
  bool depth = false;
};

/// Returns the exposed mean of a pixel. Rounds like render_film() and Film::mean(), so that a developed film has
/// exactly the codes of render().
Vec3 exposed_mean(const CellFilm& film, std::size_t pixel, float exposure) {
  return film.sum[pixel] * exposure * (1.0f / static_cast<float>(film.samples[pixel]));
}

std::size_t pixel_of(const TraceCell& cell, int x, int y) {
  return static_cast<std::size_t>((y - cell.y) * kCellPx + x - cell.x);
}

/// Returns an image for the cells of depth that the rect touches.
InverseDepthImage depth_image(const PixelRect& rect) {
  const PixelRect cells = depth_cells(rect);
  return {cells.width, cells.height};
}

/// Writes the cells of depth that `part` touches to `depth`, which has the cells that `rect` touches.
void write_depth(const TraceCell& cell, const CellPart& part, const CellFilm& film, const PixelRect& rect,
                 InverseDepthImage* depth) {
  const PixelRect to = depth_cells(rect);
  const PixelRect cells = depth_cells({part.left, part.top, part.right - part.left, part.bottom - part.top});
  for (int y = cells.y; y < cells.y + cells.height; ++y) {
    for (int x = cells.x; x < cells.x + cells.width; ++x) {
      const int from = (y - cell.y / kDepthCellPx) * kDepthsPerSide + x - cell.x / kDepthCellPx;
      *depth->at(x - to.x, y - to.y) = inverse_depth_of(film.nearest_m[static_cast<std::size_t>(from)]);
    }
  }
}

/// Working memory of one thread. It is too large for the stack, and allocating it for every cell is too slow.
struct Workspace {
  PathBatch batch;
  CellFilm film;
};

}  // namespace

struct Renderer::State {
  scene::Scene scene;
  TraceScene traced;
  std::unique_ptr<Accelerator> accelerator;
  SurfaceLevel level = SurfaceLevel::kMatte;
  ShadeStage shade = nullptr;
  std::shared_ptr<const light::LightStore> stored_light;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  double build_seconds = 0.0;
  std::shared_ptr<Crew> crew;
  mutable tbb::enumerable_thread_specific<std::unique_ptr<Workspace>> workspaces;

  RenderCost run(const PanoramaView& view, const PixelRect& rect, const std::function<bool()>& cancelled,
                 const Output& output) const;
};

static_assert(scene::kMaxSceneBounces <= kMaxBounces, "every scene's bounces must be renderable");
static_assert(kCellPx == kCostCellPx, "costs are reported in the cells in which they are measured");

Status check_view(const PanoramaView& view, const PixelRect& rect) {
  const Projection picture = view.picture();
  TRY(picture.validate());
  const auto refuse = [](std::string what) { return Error(ErrorCode::kInvalidArgument, std::move(what)); };
  if (!view.eye.allFinite()) return refuse("the eye's position is not finite");
  if (!std::isfinite(view.heading_rad)) return refuse("the heading is not finite");
  TRY(validate(view.quality));
  const auto is_level = [](float level) { return level >= 0.0f && level <= scene::kMaxLampLevel; };
  if (!std::ranges::all_of(view.lamps, is_level) || view.lamps[0] != 1.0f)
    return refuse(fmt::format("the levels of lamps are not within 0 and {}", scene::kMaxLampLevel));
  const bool inside = rect.x >= 0 && rect.y >= 0 && rect.width >= 0 && rect.height >= 0 &&
                      rect.width <= picture.width_px() - rect.x && rect.height <= picture.height_px() - rect.y;
  if (inside) return Done{};
  return refuse(fmt::format("the rectangle {}x{} at ({}, {}) is not inside the {}x{} picture", rect.width, rect.height,
                            rect.x, rect.y, picture.width_px(), picture.height_px()));
}

Renderer::Renderer(std::unique_ptr<State> state) : state_(std::move(state)) {}
Renderer::~Renderer() = default;

Result<std::unique_ptr<Renderer>> Renderer::build(scene::Scene scene, int threads,
                                                  const std::function<void(double)>& progress,
                                                  std::optional<MemoryMode> mode) {
  return build(std::move(scene), std::make_shared<Crew>(threads), progress, mode);
}

Result<std::unique_ptr<Renderer>> Renderer::build(scene::Scene scene, std::shared_ptr<Crew> crew,
                                                  const std::function<void(double)>& progress,
                                                  std::optional<MemoryMode> mode) {
  const SteadyClock clock;
  const TimePoint start = clock.now();
  auto state = std::make_unique<State>();
  state->scene = std::move(scene);
  scene::Scene& held = state->scene;
  state->crew = std::move(crew);
  state->origin = render_origin(held);
  state->level = highest_surface_level(held);
  state->shade = shade_stage_for(state->level);
  TraceScene& traced = state->traced;
  TRY_ASSIGN(state->accelerator, Accelerator::build(held, state->crew->threads(), progress, mode, &traced));
  traced.ambient = held.ambient;
  traced.eye_lamp = held.eye_lamp;
  state->build_seconds = to_seconds(clock.now() - start);
  return std::unique_ptr<Renderer>(new Renderer(std::move(state)));
}

void Renderer::use_kernel_for(SurfaceLevel at_least) {
  state_->shade = shade_stage_for(std::max(state_->level, at_least));
}

RenderCost Renderer::State::run(const PanoramaView& view, const PixelRect& rect, const std::function<bool()>& cancelled,
                                const Output& output) const {
  CHECK(check_view(view, rect).has_value());
  const SteadyClock clock;
  const TimePoint start = clock.now();
  TraceView traced_view;
  traced_view.eye = (view.eye - origin).cast<float>();
  traced_view.camera = RayCamera(view.picture(), view.heading_rad);
  traced_view.seed = view.seed;
  traced_view.quality = view.quality;
  traced_view.exposure = static_cast<float>(scene.exposure);
  traced_view.tone = scene.tone;
  traced_view.lamps = view.lamps;
  traced_view.light = view.light != nullptr ? view.light.get() : traced.light;
  traced_view.features = output.features;
  traced_view.depth = output.depth;

  const int picture_width = view.picture().width_px();
  const int picture_height = view.picture().height_px();

  std::atomic<std::uint64_t> rays = 0;
  std::atomic<double> light = 0.0;
  std::atomic<double> removed_light = 0.0;
  std::atomic<std::uint64_t> broken_samples = 0;
  // Cells are aligned to the whole picture, whichever part of it is rendered.
  const PixelRect cells = cells_touched(rect);
  std::vector<float> cell_cpu_seconds(static_cast<std::size_t>(cells.area()));
  const auto trace_one = [&](int index) {
    TraceCell cell;
    cell.x = (cells.x + index % cells.width) * kCellPx;
    cell.y = (cells.y + index / cells.width) * kCellPx;
    cell.width = std::min(kCellPx, picture_width - cell.x);
    cell.height = std::min(kCellPx, picture_height - cell.y);
    const CellPart part{std::max(cell.x, rect.x), std::max(cell.y, rect.y),
                        std::min(cell.x + cell.width, rect.x + rect.width),
                        std::min(cell.y + cell.height, rect.y + rect.height)};
    if (output.has && output.has(part)) return;
    if (cancelled && cancelled()) return;
    const double before = thread_cpu_seconds();
    const FlushDenormals flush;
    std::unique_ptr<Workspace>& workspace = workspaces.local();
    if (workspace == nullptr) workspace = std::make_unique<Workspace>();
    CellFilm& film = workspace->film;
    film.clear();
    rays += sample_cell(traced, shade, traced_view, cell, workspace->batch, film);
    output.write(cell, part, film);
    light += film.light;
    removed_light += film.removed_light;
    broken_samples += film.broken_samples;
    cell_cpu_seconds[static_cast<std::size_t>(index)] = static_cast<float>(thread_cpu_seconds() - before);
  };
  const int count = static_cast<int>(cells.area());
  if (count == 1) {
    trace_one(0);
  } else {
    crew->run(count, trace_one);
  }
  const double cpu_seconds = std::accumulate(cell_cpu_seconds.begin(), cell_cpu_seconds.end(), 0.0);
  const double all_light = light + removed_light;
  return {cpu_seconds,    to_seconds(clock.now() - start), rays, all_light > 0.0 ? removed_light / all_light : 0.0,
          broken_samples, std::move(cell_cpu_seconds)};
}

RenderCost Renderer::render(const PanoramaView& view, const PixelRect& rect, RgbImage* ret_pixels,
                            const std::function<bool()>& cancelled, InverseDepthImage* ret_depth) const {
  *ret_pixels = RgbImage(rect.width, rect.height);
  const bool with_depth = view.depth && ret_depth != nullptr;
  if (ret_depth != nullptr) *ret_depth = view.depth ? depth_image(rect) : InverseDepthImage();
  const auto exposure = static_cast<float>(state_->scene.exposure);
  const ToneTable& tone = tone_table(state_->scene.tone);
  const auto write = [&](const TraceCell& cell, const CellPart& part, const CellFilm& film) {
    for (int y = part.top; y < part.bottom; ++y) {
      std::uint8_t* out = ret_pixels->at(part.left - rect.x, y - rect.y);
      for (int x = part.left; x < part.right; ++x, out += 3) {
        const Vec3 mean = exposed_mean(film, pixel_of(cell, x, y), exposure);
        for (int c = 0; c < 3; ++c) out[c] = tone.code(mean[c]);
      }
    }
    if (with_depth) write_depth(cell, part, film, rect, ret_depth);
  };
  return state_->run(view, rect, cancelled, {.write = write, .depth = with_depth});
}

RenderCost Renderer::render_film(const PanoramaView& view, const PixelRect& rect, bool with_features, Film* ret_film,
                                 const std::function<bool()>& cancelled) const {
  *ret_film = Film(rect.width, rect.height, with_features);
  if (view.depth) ret_film->depth = depth_image(rect);
  return finish_film(view, rect, ret_film, cancelled);
}

RenderCost Renderer::finish_film(const PanoramaView& view, const PixelRect& rect, Film* to,
                                 const std::function<bool()>& cancelled) const {
  CHECK(to->width() == rect.width && to->height() == rect.height);
  const bool with_features = !to->features.albedo.empty();
  const bool with_depth = !to->depth.empty();
  const auto exposure = static_cast<float>(state_->scene.exposure);
  const auto has = [&](const CellPart& part) { return *to->samples.at(part.left - rect.x, part.top - rect.y) > 0; };
  const auto write = [&](const TraceCell& cell, const CellPart& part, const CellFilm& film) {
    for (int y = part.top; y < part.bottom; ++y) {
      for (int x = part.left; x < part.right; ++x) {
        const std::size_t pixel = pixel_of(cell, x, y);
        const int column = x - rect.x;
        const int row = y - rect.y;
        Eigen::Map<Vec3>(to->sum.at(column, row)) = film.sum[pixel] * exposure;
        *to->square.at(column, row) = film.square[pixel] * exposure * exposure;
        *to->samples.at(column, row) = film.samples[pixel];
        if (!with_features) continue;
        const float share = 1.0f / static_cast<float>(film.samples[pixel]);
        Eigen::Map<Vec3>(to->features.albedo.at(column, row)) = film.albedo[pixel] * share;
        Eigen::Map<Vec3>(to->features.normal.at(column, row)) = film.normal[pixel] * share;
        *to->features.distance.at(column, row) = film.distance[pixel] * share;
      }
    }
    if (with_depth) write_depth(cell, part, film, rect, &to->depth);
  };
  return state_->run(view, rect, cancelled, {write, has, with_features, with_depth});
}

RenderCost Renderer::render_radiance(const PanoramaView& view, const PixelRect& rect, RadianceImage* ret_pixels,
                                     const std::function<bool()>& cancelled) const {
  Film film;
  const RenderCost cost = render_film(view, rect, false, &film, cancelled);
  *ret_pixels = film.mean();
  return cost;
}

Status Renderer::set_light(std::shared_ptr<const light::LightStore> store, std::string_view name) {
  if (store != nullptr) TRY(check_light(*store, name));
  use_light(std::move(store));
  return Done{};
}

Status Renderer::check_light(const light::LightStore& store, std::string_view name) const {
  std::vector<light::PlacementSize> sizes;
  for (const Placement& placement : state_->traced.placements) {
    sizes.push_back({placement.mesh->vertex_count, placement.mesh->triangle_count});
  }
  return light::check_fits(store, light::key_of(state_->scene), sizes, name);
}

void Renderer::use_light(std::shared_ptr<const light::LightStore> store) {
  state_->stored_light = std::move(store);
  state_->traced.light = state_->stored_light.get();
}

const light::LightStore* Renderer::light() const { return state_->stored_light.get(); }
const TraceScene& Renderer::traced() const { return state_->traced; }
SurfaceLevel Renderer::surface_level() const { return state_->level; }
const Eigen::Vector3d& Renderer::origin() const { return state_->origin; }
Crew& Renderer::crew() const { return *state_->crew; }
const scene::Scene& Renderer::scene() const { return state_->scene; }
const LightSet& Renderer::lights() const { return state_->traced.lights; }
double Renderer::build_seconds() const { return state_->build_seconds; }
MemoryMode Renderer::memory_mode() const { return state_->accelerator->mode(); }
std::size_t Renderer::bvh_bytes() const { return state_->accelerator->bytes(); }
std::size_t Renderer::shading_bytes() const {
  std::size_t bytes = mip_bytes() + lights().bytes();
  for (const SurfaceMesh& mesh : state_->traced.meshes) bytes += mesh.records.size() * sizeof(TriangleRecord);
  return bytes;
}
std::size_t Renderer::mip_bytes() const { return state_->traced.textures.bytes(); }

}  // namespace cyclorama::render
