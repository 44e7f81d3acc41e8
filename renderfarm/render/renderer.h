// SPDX-License-Identifier: Apache-2.0
/// Panorama pixels out of a scene. The node and the tools stand on this; Embree is behind it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "common/base/result.h"
#include "common/geometry/projection.h"
#include "common/image/image.h"
#include "common/image/pixel_rect.h"
#include "renderfarm/render/film.h"
#include "renderfarm/render/quality.h"

namespace cyclorama {

class LightSet;
struct Scene;
struct SceneNeeds;

/// A picture to be made: where the eye is, where it looks, how finely. Scene frame.
struct PanoramaView {
  Eigen::Vector3d eye = Eigen::Vector3d::Zero();
  double heading_rad = 0.0;
  Panorama panorama;
  RenderQuality quality;
  std::uint64_t seed = 0;  ///< With pixel and sample it decides every random number: tiling changes nothing.
  std::optional<Projection> projection = std::nullopt;  ///< What the picture is, if not `panorama` seen by one eye.

  [[nodiscard]] Projection picture() const { return projection ? *projection : Projection{panorama, {}}; }
};

/// kInvalidArgument, in one sentence, unless the view is finite and possible and `rect` lies inside its picture: what
/// a view from outside must pass before it is rendered.
Status check_view(const PanoramaView& view, const PixelRect& rect);

struct RenderCost {
  double cpu_seconds = 0.0;  ///< Thread time, summed over the threads.
  double wall_seconds = 0.0;
  std::uint64_t rays = 0;
  /// The firefly limit's own bias: the part of all light that it took away.
  double removed_light = 0.0;
  std::uint64_t broken_samples = 0;  ///< That were NaN and are black in the picture: a bug if there are any.
  /// Thread time of each 16x16 cell of the picture's grid that the rect touches, row by row; their sum is cpu_seconds.
  /// Zero where a cell was not rendered.
  std::vector<float> cell_cpu_seconds{};
};

/// One scene, committed for tracing. Thread-safe once built: several threads may call render() with their own pictures.
class Renderer {
 public:
  /// Takes the scene and builds the BVH with `threads` threads (0: all of them). `progress` may be null.
  /// kInvalidArgument  the scene has no triangles.     kSystem  out of memory, said before the machine swaps.
  static Result<std::unique_ptr<Renderer>> build(Scene scene, int threads, const std::function<void(double)>& progress);
  ~Renderer();
  /// Picks a kernel that is compiled for the scene's needs and for those of `more`, though nothing uses them: what they
  /// cost is measured so. Not while a picture is rendered.
  void compile_for(const SceneNeeds& more);
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Renders `rect` of the view into `ret_pixels`, resized to the rect, tone mapped, sRGB. Stops early, leaving pixels
  /// black, when `cancelled` (may be null) returns true; it is asked once per 16x16 cell, from any thread. A rect of
  /// one such cell is rendered by the calling thread. Precondition: check_view().
  RenderCost render(const PanoramaView& view, const PixelRect& rect, RgbImage* ret_pixels,
                    const std::function<bool()>& cancelled) const;
  /// The samples themselves, exposed but not tone mapped, into `ret_film`, made anew in the rect's size.
  RenderCost render_film(const PanoramaView& view, const PixelRect& rect, bool with_features, Film* ret_film,
                         const std::function<bool()>& cancelled) const;
  /// Goes on with a film of the rect's size whose making was cancelled: cells that have samples stay as they are, so
  /// that nothing is rendered twice and the film becomes the one of render_film(), to the last bit. A new Film has
  /// none.
  RenderCost finish_film(const PanoramaView& view, const PixelRect& rect, Film* film,
                         const std::function<bool()>& cancelled) const;
  /// Their mean: linear radiance times exposure.
  RenderCost render_radiance(const PanoramaView& view, const PixelRect& rect, RadianceImage* ret_pixels,
                             const std::function<bool()>& cancelled) const;

  [[nodiscard]] const Scene& scene() const;
  [[nodiscard]] const LightSet& lights() const;  ///< In the render frame.
  [[nodiscard]] double build_seconds() const;
  [[nodiscard]] std::size_t bvh_bytes() const;
  [[nodiscard]] std::size_t mip_bytes() const;  ///< Of the textures' smaller levels.
  /// Of all that shading reads besides the scene: records of the triangles, smaller textures, tables of the lights.
  [[nodiscard]] std::size_t shading_bytes() const;

 private:
  struct State;
  explicit Renderer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace cyclorama
