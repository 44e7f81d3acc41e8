// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/embree_block_renderer.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <utility>

#include "common/wire/convert.h"
#include "renderfarm/denoise/denoising_renderer.h"
#include "renderfarm/governor/pareto_front_file.h"
#include "renderfarm/governor/stored_light_front.h"
#include "renderfarm/light/light_file.h"
#include "renderfarm/render/memory.h"
#include "renderfarm/render/tone.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama::node {
namespace {

/// Approximate share of reading in the time from the first byte to the first ray; the rest builds the BVH.
constexpr double kReadingShare = 0.6;

class EmbreeDenoisedWork final : public DenoisedWork {
 public:
  EmbreeDenoisedWork(denoise::DenoisingRenderer& denoising, render::PanoramaView view, const PixelRect& rect)
      : denoising_(denoising), view_(std::move(view)), rect_(rect) {}

  render::RenderCost advance(const std::function<bool()>& stop, RgbImage* ret_pixels,
                             InverseDepthImage* ret_depth) override {
    return denoising_.advance(view_, rect_, &picture_, stop, ret_pixels, ret_depth);
  }

 private:
  denoise::DenoisingRenderer& denoising_;
  const render::PanoramaView view_;
  const PixelRect rect_;
  denoise::UnfinishedPicture picture_;
};

class EmbreeBlockRenderer final : public BlockRenderer {
 public:
  EmbreeBlockRenderer(std::unique_ptr<render::Renderer> renderer, int threads, std::string note)
      : renderer_(std::move(renderer)), denoising_(*renderer_, threads), note_(std::move(note)) {}

  [[nodiscard]] std::unique_ptr<DenoisedWork> begin_denoised(const render::PanoramaView& view,
                                                             const PixelRect& rect) override {
    return std::make_unique<EmbreeDenoisedWork>(denoising_, view, rect);
  }

  render::RenderCost render_film(const render::PanoramaView& view, const PixelRect& rect,
                                 const governor::SampleRange& samples, render::Film* film,
                                 const std::function<bool()>& cancelled) override {
    render::PanoramaView part = view;
    if (part.quality.sequence == 0) part.quality.sequence = view.quality.first_sample + view.quality.samples;
    part.quality.first_sample = samples.first;
    part.quality.samples = samples.end - samples.first;
    return renderer_->finish_film(part, rect, film, cancelled);
  }

  [[nodiscard]] RgbImage developed(const render::Film& film) const override {
    return cyclorama::render::developed(film.mean(), renderer_->scene().tone);
  }

  [[nodiscard]] wire::SceneDescription description() const override {
    const scene::Scene& scene = renderer_->scene();
    wire::SceneDescription out;
    out.set_title(scene.info.title);
    out.set_credits(scene.info.credits);
    out.set_triangles_seen(scene.triangles_seen());
    out.set_triangles_stored(scene.triangles_stored());
    to_wire(scene.info.start_eye, out.mutable_start_eye_m());
    out.set_start_heading_rad(scene.info.start_heading_rad);
    out.set_eye_height_m(scene.info.eye_height_m);
    out.set_walking_scale(scene.info.walking_scale);
    for (const Eigen::Vector2d& corner : scene.info.walkable) {
      wire::GroundPoint* const point = out.add_walkable();
      point->set_x_m(corner.x());
      point->set_z_m(corner.y());
    }
    for (const std::vector<Eigen::Vector2d>& hole : scene.info.walkable_holes) {
      wire::GroundPolygon* const polygon = out.add_walkable_holes();
      for (const Eigen::Vector2d& corner : hole) {
        wire::GroundPoint* const point = polygon->add_corners();
        point->set_x_m(corner.x());
        point->set_z_m(corner.y());
      }
    }
    for (const scene::SceneTourStop& stop : scene.info.stops) {
      wire::TourStop* const out_stop = out.add_stops();
      out_stop->set_title(stop.title);
      to_wire(stop.eye, out_stop->mutable_eye_m());
      out_stop->set_heading_rad(stop.heading_rad);
    }
    return out;
  }

  [[nodiscard]] std::string pareto_front() const override {
    if (renderer_->light() == nullptr) return {};
    return governor::pareto_front_text(governor::stored_light_front(renderer_->scene().bounces), "");
  }

  [[nodiscard]] std::string note() const override { return note_; }

  [[nodiscard]] bool wants_light() const override {
    return renderer_->light() == nullptr && renderer_->scene().eye_lamp.isZero(0.0f);
  }

  [[nodiscard]] Result<std::function<void()>> light_from(const std::filesystem::path& file) const override {
    TRY_ASSIGN(light::LightStore read, light::read_light_file(file));
    const auto store = std::make_shared<light::LightStore>(std::move(read));
    TRY(renderer_->check_light(*store, file.string()));
    return std::function<void()>([this, store] { renderer_->use_light(store); });
  }

  [[nodiscard]] std::uint64_t memory_bytes() const override {
    const std::size_t light = renderer_->light() == nullptr ? 0 : renderer_->light()->bytes();
    return light + renderer_->scene().memory_bytes() + renderer_->shading_bytes() + renderer_->bvh_bytes();
  }

  [[nodiscard]] int bounces() const override { return renderer_->scene().bounces; }

  [[nodiscard]] double probe_cpu_seconds() override {
    render::PanoramaView view;
    view.eye = renderer_->scene().info.start_eye;
    view.heading_rad = renderer_->scene().info.start_heading_rad;
    view.panorama = {64, 32, 2.0, 0.5, -0.5};
    view.quality.samples = 1;
    const PixelRect whole{0, 0, view.panorama.width_px, view.panorama.height_px};
    double min = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) {  // The first run warms the caches; the minimum excludes other load of the host.
      RgbImage picture;
      min = std::min(min, renderer_->render(view, whole, &picture, nullptr).cpu_seconds);
    }
    return min / (1e-6 * static_cast<double>(whole.area()));
  }

 private:
  const std::unique_ptr<render::Renderer> renderer_;
  denoise::DenoisingRenderer denoising_;
  const std::string note_;
};

/// Gives the renderer the light that is stored in the scene's folder, if there is any. Errors: as light_file.h. The
/// renderer traces paths then.
Status load_stored_light(const std::filesystem::path& scene, render::Renderer* renderer) {
  const std::filesystem::path file = scene / light::kLightFileName;
  std::error_code none;
  if (!std::filesystem::is_regular_file(file, none)) return Done{};
  Result<light::LightStore> store = light::read_light_file(file);
  if (!store) return store.error();
  return renderer->set_light(std::make_shared<light::LightStore>(*std::move(store)), file.string());
}

}  // namespace

SceneLoader embree_scene_loader(int threads) {
  return [threads](const std::string& path,
                   const std::function<void(double)>& progress) -> Result<std::unique_ptr<BlockRenderer>> {
    scene::ImportLimits limits;
    limits.memory_bytes =
        std::min(limits.memory_bytes, cyclorama::render::available_memory().value_or(limits.memory_bytes));
    TRY_ASSIGN(scene::Scene scene,
               scene::load_scene(path, limits, [&](double done) { progress(kReadingShare * done); }));
    TRY_ASSIGN(auto renderer, render::Renderer::build(std::move(scene), threads, [&](double done) {
                 progress(kReadingShare + (1.0 - kReadingShare) * done);
               }));
    const Status light = load_stored_light(path, renderer.get());
    std::string note = light ? std::string() : light.error().message();
    return std::unique_ptr<BlockRenderer>(
        std::make_unique<EmbreeBlockRenderer>(std::move(renderer), threads, std::move(note)));
  };
}

}  // namespace cyclorama::node
