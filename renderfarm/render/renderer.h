// SPDX-License-Identifier: Apache-2.0
/// Renders the pixels of a scene's pictures. The node and the tools use this interface; it hides Embree.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "common/geometry/projection.h"
#include "common/image/image.h"
#include "common/image/inverse_depth.h"
#include "common/image/pixel_rect.h"
#include "renderfarm/render/film.h"
#include "renderfarm/render/quality.h"
#include "renderfarm/scene/lamp_groups.h"

namespace cyclorama::light {
struct LightStore;
}  // namespace cyclorama::light

namespace cyclorama::scene {
struct Scene;
}  // namespace cyclorama::scene

namespace cyclorama::render {

class Crew;
class LightSet;
enum class MemoryMode : std::uint8_t;
enum class SurfaceLevel : std::uint8_t;
struct TraceScene;

/// The picture to render: eye, heading, shape and quality, in the Scene frame.
struct PanoramaView {
  Eigen::Vector3d eye = Eigen::Vector3d::Zero();
  double heading_rad = 0.0;
  Panorama panorama;
  RenderQuality quality;
  /// Determines every random number, together with the pixel and the sample's number; tiling has no effect.
  std::uint64_t seed = 0;
  /// Stored light that RenderQuality::stored_light reads; null: that of Renderer::set_light().
  std::shared_ptr<const light::LightStore> light = nullptr;
  std::optional<Projection> projection = std::nullopt;  ///< The picture's shape; null means `panorama` seen by one eye.
  scene::LampLevels lamps = scene::kAuthoredLamps;      ///< Each in [0, kMaxLampLevel]; that of group 0 is 1.
  bool depth = false;  ///< Also records the inverse depth of each cell of 4x4 pixels, without effect on the picture.

  [[nodiscard]] Projection picture() const { return projection ? *projection : Projection{panorama, {}}; }
};

/// Checks an untrusted view before it is rendered. Errors: kInvalidArgument, with a message of one sentence, unless the
/// view is finite and valid and `rect` lies inside its picture.
Status check_view(const PanoramaView& view, const PixelRect& rect);

struct RenderCost {
  double cpu_seconds = 0.0;  ///< Thread time, summed over all threads.
  double wall_seconds = 0.0;
  std::uint64_t rays = 0;
  /// Bias of the firefly limit: share of all light that it removed.
  double removed_light = 0.0;
  /// Samples that were NaN and are black in the picture; more than 0 indicates a bug.
  std::uint64_t broken_samples = 0;
  /// Thread time of each 16x16 cell of the picture's grid that the rect touches, row by row; their sum is cpu_seconds.
  /// Zero for a cell that was not rendered.
  std::vector<float> cell_cpu_seconds{};
};

/// One scene, committed for tracing. Thread-safe once built: several threads may call render() with their own images.
class Renderer {
 public:
  /// Takes the scene and builds the BVH with `threads` threads (0 uses all cores). `progress` may be null. `mode` null
  /// selects the fastest one that fits. Errors: kInvalidArgument if the scene has neither triangles nor splats; kSystem
  /// if the scene would not fit into memory, which is checked before the machine swaps.
  static Result<std::unique_ptr<Renderer>> build(scene::Scene scene, int threads,
                                                 const std::function<void(double)>& progress,
                                                 std::optional<MemoryMode> mode = std::nullopt);
  /// The same with threads that other renderers may use, too.
  static Result<std::unique_ptr<Renderer>> build(scene::Scene scene, std::shared_ptr<Crew> crew,
                                                 const std::function<void(double)>& progress,
                                                 std::optional<MemoryMode> mode = std::nullopt);
  ~Renderer();
  /// Selects the kernel for surfaces of at least this level even if the scene needs less, to measure what higher levels
  /// cost. Must not be called while a picture is rendered.
  void use_kernel_for(SurfaceLevel at_least);
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Renders `rect` of the view into `ret_pixels`, which is resized to the rect; the result is tone mapped sRGB. Stops
  /// early and leaves the remaining pixels black once `cancelled` (may be null) returns true; it is called once per
  /// 16x16 cell, from any thread. A rect inside one cell is rendered by the calling thread. `ret_depth` (may be null)
  /// becomes the depth of the cells that the rect touches, like Film::depth. Precondition: check_view() succeeds.
  RenderCost render(const PanoramaView& view, const PixelRect& rect, RgbImage* ret_pixels,
                    const std::function<bool()>& cancelled, InverseDepthImage* ret_depth = nullptr) const;
  /// Renders the samples, exposed but not tone mapped, into `ret_film`, which is recreated in the rect's size.
  RenderCost render_film(const PanoramaView& view, const PixelRect& rect, bool with_features, Film* ret_film,
                         const std::function<bool()>& cancelled) const;
  /// Completes a film of the rect's size whose rendering was cancelled. Cells that have samples already are kept, so
  /// nothing is rendered twice and the result is bit-identical to that of render_film(). A new Film has no samples.
  /// Features and depth are computed if the film has images for them, whatever the view requests.
  RenderCost finish_film(const PanoramaView& view, const PixelRect& rect, Film* film,
                         const std::function<bool()>& cancelled) const;
  /// Renders the mean of the samples: linear radiance times exposure.
  RenderCost render_radiance(const PanoramaView& view, const PixelRect& rect, RadianceImage* ret_pixels,
                             const std::function<bool()>& cancelled) const;

  /// Sets the stored light that RenderQuality::stored_light reads; null removes it. Must not be called while a picture
  /// is rendered. Errors: kBadData, naming `name`, if the light was computed for another scene; the previous light then
  /// stays.
  Status set_light(std::shared_ptr<const light::LightStore> store, std::string_view name);
  /// check_light() and use_light() are the two parts of set_light(): the check, which takes time and is thread-safe,
  /// and the switch, which is immediate.
  [[nodiscard]] Status check_light(const light::LightStore& store, std::string_view name) const;
  void use_light(std::shared_ptr<const light::LightStore> store);
  [[nodiscard]] const light::LightStore* light() const;  ///< Null if there is none.
  /// Returns everything that the kernels read, for light_baking, which traces rays itself.
  [[nodiscard]] const TraceScene& traced() const;
  [[nodiscard]] SurfaceLevel surface_level() const;     ///< The highest level of the scene's materials.
  [[nodiscard]] const Eigen::Vector3d& origin() const;  ///< The render frame's origin, in the Scene frame.

  [[nodiscard]] Crew& crew() const;  ///< The threads that trace, for further work on pictures.
  [[nodiscard]] const scene::Scene& scene() const;
  [[nodiscard]] const LightSet& lights() const;  ///< Render frame.
  [[nodiscard]] double build_seconds() const;
  [[nodiscard]] MemoryMode memory_mode() const;
  [[nodiscard]] std::size_t bvh_bytes() const;
  [[nodiscard]] std::size_t mip_bytes() const;  ///< Size of the textures' smaller levels.
  /// Returns the size of all that shading reads besides the scene: triangle records, smaller texture levels, tables of
  /// the lights.
  [[nodiscard]] std::size_t shading_bytes() const;

 private:
  struct State;
  explicit Renderer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace cyclorama::render
