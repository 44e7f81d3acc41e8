// SPDX-License-Identifier: Apache-2.0
/// Traces the paths of a cell of pixels. The shading stage is compiled once for each surface level, without the code of
/// higher levels; the scene's level selects the one that is used.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "common/image/inverse_depth.h"
#include "renderfarm/render/camera.h"
#include "renderfarm/render/path_batch.h"
#include "renderfarm/render/quality.h"
#include "renderfarm/render/surface_level.h"
#include "renderfarm/render/trace_scene.h"
#include "renderfarm/scene/lamp_groups.h"

namespace cyclorama::render {

/// Width and height of a cell, in pixels. Cells are aligned to the picture, so their content never depends on the
/// tiling.
inline constexpr int kCellPx = 16;
inline constexpr int kCellPixels = kCellPx * kCellPx;
inline constexpr int kDepthsPerSide = kCellPx / kDepthCellPx;  ///< Number of cells of depth along each side of a cell.
inline constexpr int kCellDepths = kDepthsPerSide * kDepthsPerSide;
static_assert(kCellPx % kDepthCellPx == 0, "no cell of depth may lie in two cells");

/// A PanoramaView, converted to the render frame.
struct TraceView {
  Vec3 eye = Vec3::Zero();
  RayCamera camera;
  std::uint64_t seed = 0;
  RenderQuality quality;
  float exposure = 1.0f;
  scene::ToneCurve tone = scene::ToneCurve::kShoulder;
  scene::LampLevels lamps = scene::kAuthoredLamps;
  const light::LightStore* light = nullptr;  ///< Stored light, which fits the placements; null if there is none.
  bool features = false;
  bool depth = false;
  /// Paths of more scatterings do not read stored light. It holds all bounces, so a path that reads it late has more
  /// than a traced one.
  int max_stored_scatterings = 255;
};

/// Unit of work: some samples of the pixels of one cell.
struct TraceCell {
  int x = 0;  ///< First pixel in the picture; a multiple of kCellPx.
  int y = 0;
  int width = kCellPx;  ///< Smaller at the picture's edges.
  int height = kCellPx;
  int first_sample = 0;
  int samples = 1;
  /// The only sample is at the middle of each pixel. This suits stored light, which has no noise: at edges the error is
  /// half that of a random position, and edges do not flicker from frame to frame.
  bool middle = false;
};

/// Sums over a cell's samples, pixel by pixel in rows of kCellPx. Radiance is not multiplied by the exposure.
struct CellFilm {
  std::array<Vec3, kCellPixels> sum;
  std::array<float, kCellPixels> square;  ///< Sum of squared luminance.
  std::array<std::int32_t, kCellPixels> samples;
  std::array<Vec3, kCellPixels> albedo;  ///< Sum over the samples, as are `normal` and `distance`.
  std::array<Vec3, kCellPixels> normal;
  std::array<float, kCellPixels> distance;
  std::array<bool, kCellPixels> active;  ///< Pixels that need more samples.
  /// Pixels that show a surface without stored light, whose samples are therefore noisy.
  std::array<bool, kCellPixels> lacks_light;
  /// Distance along the ray, in metres, of the nearest surface that the eye sees in each cell of depth, in rows of
  /// kDepthsPerSide. Infinite where the eye sees no surface, and everywhere unless the view requests depth.
  std::array<float, kCellDepths> nearest_m;
  double light = 0.0;                ///< Sum of the luminance of all samples.
  double removed_light = 0.0;        ///< Luminance that the firefly limit removed.
  std::uint64_t broken_samples = 0;  ///< Samples that were NaN and count as black.

  void clear();
  /// Discards the samples of the active pixels.
  void restart_active();
};

/// Shades the hits of the rays in `batch`: collects light, traces shadow rays and generates the next rays.
using ShadeStage = void (*)(const TraceScene& scene, const TraceView& view, PathBatch& batch, CellFilm& film);

/// Returns the stage for surfaces of `level` and below.
[[nodiscard]] ShadeStage shade_stage_for(SurfaceLevel level);

/// Upper bound of a sample's exposed radiance: the sum of kMaxSamples of its squares is finite in float. For
/// comparison, the sun's disc has 2e9 cd/m^2.
inline constexpr float kBrightest = 1e16f;

/// Traces the rays of batch.current() and all rays that follow from them; the paths' light is in batch.path afterwards.
/// Precondition: each path has the state of its random numbers. Reentrant.
void trace_paths(const TraceScene& scene, ShadeStage shade, const TraceView& view, Coherence first, PathBatch& batch,
                 CellFilm& film);

/// Adds the samples of `cell`, which are finite and not negative, to `film`. Returns the number of rays. Reentrant;
/// `batch` is scratch.
std::uint64_t trace_cell(const TraceScene& scene, ShadeStage shade, const TraceView& view, const TraceCell& cell,
                         PathBatch& batch, CellFilm& film);

}  // namespace cyclorama::render
