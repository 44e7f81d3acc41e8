// SPDX-License-Identifier: Apache-2.0
/// From a cell of pixels to its light. The stage that differs between scenes, what happens at a surface, exists once
/// for each combination of needs, compiled without the rest.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "renderfarm/render/camera.h"
#include "renderfarm/render/path_batch.h"
#include "renderfarm/render/quality.h"
#include "renderfarm/render/requirements.h"
#include "renderfarm/render/trace_scene.h"

namespace cyclorama {

/// Cells are squares of this many pixels, aligned to the picture: what is in one never depends on the tiling.
inline constexpr int kCellPx = 16;
inline constexpr int kCellPixels = kCellPx * kCellPx;

/// A PanoramaView in the render frame.
struct TraceView {
  Vec3 eye = Vec3::Zero();
  Camera camera;
  std::uint64_t seed = 0;
  RenderQuality quality;
  float exposure = 1.0f;
  ToneCurve tone = ToneCurve::kShoulder;
  bool features = false;
};

/// A piece of work: some samples of the pixels of one cell.
struct TraceCell {
  int x = 0;  ///< Of its first pixel in the picture; a multiple of kCellPx.
  int y = 0;
  int width = kCellPx;  ///< Less at the picture's edges.
  int height = kCellPx;
  int first_sample = 0;
  int samples = 1;
};

/// What a cell's samples add up to, pixel by pixel in rows of kCellPx. Radiance is not exposed.
struct CellFilm {
  std::array<Vec3, kCellPixels> sum;
  std::array<float, kCellPixels> square;  ///< Of luminance.
  std::array<std::int32_t, kCellPixels> samples;
  std::array<Vec3, kCellPixels> albedo;  ///< Sums, too.
  std::array<Vec3, kCellPixels> normal;
  std::array<float, kCellPixels> distance;
  std::array<bool, kCellPixels> active;  ///< Pixels that want samples.
  double light = 0.0;                    ///< Luminance of all samples.
  double removed_light = 0.0;            ///< What the firefly limit took away of it.
  std::uint64_t broken_samples = 0;      ///< That were NaN, and counted as black.

  void clear();
};

/// What happens where the rays of `batch` ended: light is collected, shadow rays are traced, next rays are made.
using ShadeStage = void (*)(const TraceScene& scene, const TraceView& view, PathBatch& batch, CellFilm& film);

/// The one that is compiled for the fewest needs that hold all of `needs`.
[[nodiscard]] ShadeStage shade_stage_for(const SceneNeeds& needs);

/// The most that a sample counts for, exposed: the sum of kMostSamples squares of it is a float. The sun's disc has
/// 2e9 cd/m^2.
inline constexpr float kBrightest = 1e16f;

/// Adds the samples of `cell` to `film`: finite, not negative. Returns the number of rays. Reentrant; `batch` is
/// scratch.
std::uint64_t trace_cell(const TraceScene& scene, ShadeStage shade, const TraceView& view, const TraceCell& cell,
                         PathBatch& batch, CellFilm& film);

}  // namespace cyclorama
