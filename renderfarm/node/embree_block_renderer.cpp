// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/embree_block_renderer.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <utility>

#include "common/base/file.h"
#include "common/wire/convert.h"
#include "renderfarm/denoise/denoising_renderer.h"
#include "renderfarm/light/light_file.h"
#include "renderfarm/render/memory.h"
#include "renderfarm/render/tone.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama::node {
namespace {

/// Approximate share of reading files in the time from the first byte to the first ray; the rest is building the BVH.
constexpr double kReadingShare = 0.6;

class EmbreeDenoisedWork final : public DenoisedWork {
 public:
  EmbreeDenoisedWork(denoise::DenoisingRenderer& denoising, render::PanoramaView view, const PixelRect& rect)
      : denoising_(denoising), view_(std::move(view)), rect_(rect) {}

  render::RenderCost advance(const std::function<bool()>& stop, RadianceImage* ret_light,
                             InverseDepthImage* ret_depth) override {
    return denoising_.advance(view_, rect_, &picture_, stop, ret_light, ret_depth);
  }

 private:
  denoise::DenoisingRenderer& denoising_;
  const render::PanoramaView view_;
  const PixelRect rect_;
  denoise::UnfinishedPicture picture_;
};

class EmbreeBlockRenderer final : public BlockRenderer {
 public:
  explicit EmbreeBlockRenderer(std::unique_ptr<render::Renderer> renderer)
      : renderer_(std::move(renderer)), denoising_(*renderer_) {}

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

  [[nodiscard]] RgbImage developed(const RadianceImage& mean) const override {
    return cyclorama::render::developed(mean, renderer_->scene().tone);
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
    for (const std::string& group : scene.info.lamp_groups) out.add_lamp_groups(group);
    return out;
  }

  [[nodiscard]] std::string note() const override { return note_; }

  [[nodiscard]] bool can_have_light() const override { return !renderer_->scene().model.instances.empty(); }

  Result<VersionedLight> add_light(std::span<const std::byte> file, std::string_view name) override {
    TRY_ASSIGN(light::LightStore read, light::parse_light_file(file, name));
    TRY(renderer_->check_light(read, name));
    VersionedLight added{version_of(file), file.size(), std::make_shared<light::LightStore>(std::move(read))};
    lights_.add(added);
    return added;
  }

  [[nodiscard]] const LightVersions* light_versions() const override { return &lights_; }

  /// Adds the light that is stored in the scene's folder, if any. If it cannot be used, note() states the reason.
  void add_stored_light(const std::filesystem::path& scene) {
    const std::filesystem::path path = scene / light::kLightFileName;
    std::error_code none;
    if (!std::filesystem::is_regular_file(path, none)) return;
    const auto file = MappedFile::open(path);
    const auto light = file ? add_light(file->bytes(), path.string()) : Result<VersionedLight>(file.error());
    if (light) {
      renderer_->use_light(light->store);
    } else {
      note_ = light.error().message();
    }
  }

  [[nodiscard]] std::uint64_t memory_bytes() const override {
    return lights_.bytes() + renderer_->scene().memory_bytes() + renderer_->shading_bytes() + renderer_->bvh_bytes();
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
    for (int i = 0; i < 3; ++i) {  // The first run warms the caches; the minimum excludes other load on the host.
      RgbImage picture;
      min = std::min(min, renderer_->render(view, whole, &picture, nullptr).cpu_seconds);
    }
    return min / (1e-6 * static_cast<double>(whole.area()));
  }

 private:
  const std::unique_ptr<render::Renderer> renderer_;
  denoise::DenoisingRenderer denoising_;
  LightVersions lights_;
  std::string note_;
};

}  // namespace

SceneLoader embree_scene_loader(std::shared_ptr<render::Crew> crew) {
  return [crew = std::move(crew)](
             const std::string& path,
             const std::function<void(double)>& progress) -> Result<std::unique_ptr<BlockRenderer>> {
    scene::ImportLimits limits;
    limits.memory_bytes =
        std::min(limits.memory_bytes, cyclorama::render::available_memory().value_or(limits.memory_bytes));
    TRY_ASSIGN(scene::Scene scene,
               scene::load_scene(path, limits, [&](double done) { progress(kReadingShare * done); }));
    TRY_ASSIGN(auto renderer, render::Renderer::build(std::move(scene), crew, [&](double done) {
                 progress(kReadingShare + (1.0 - kReadingShare) * done);
               }));
    auto made = std::make_unique<EmbreeBlockRenderer>(std::move(renderer));
    made->add_stored_light(path);
    return std::unique_ptr<BlockRenderer>(std::move(made));
  };
}

}  // namespace cyclorama::node
