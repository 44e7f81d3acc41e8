// SPDX-License-Identifier: Apache-2.0
/// A scene's pictures with the noise taken out: traced with a margin, denoised, cut to what was asked for.
///
/// The margin is Denoiser::halo_px() on each side where the picture goes on, traced in whole cells of 16x16 pixels, so
/// a small rect costs more per pixel than a large one. The pixels are those of the whole picture to the last bit. Of
/// two eyes' pictures each is one for itself: nothing of the other comes into it.
#pragma once

#include <vector>

#include "renderfarm/denoise/denoise.h"
#include "renderfarm/render/renderer.h"

namespace cyclorama {

/// kInvalidArgument, one sentence, for two eyes' pictures that no cut of kCutPx pixels parts.
[[nodiscard]] Status check_denoisable(const PanoramaView& view);

/// Keeps its memory from one picture to the next, and a reference to the renderer, which must outlive it. Thread-bound.
class DenoisingRenderer {
 public:
  /// `threads` take the noise out (0: as many as there are cores); the pixels do not depend on their number.
  DenoisingRenderer(const Renderer& renderer, int threads);

  /// As Renderer's of these names; the cost has the margin and the filter in it. Precondition: check_view() and
  /// check_denoisable().
  RenderCost render(const PanoramaView& view, const PixelRect& rect, RgbImage* ret_pixels,
                    const std::function<bool()>& cancelled);
  RenderCost render_radiance(const PanoramaView& view, const PixelRect& rect, RadianceImage* ret_pixels,
                             const std::function<bool()>& cancelled);

 private:
  /// `rect` and its margin lie inside of `bounds`.
  RenderCost render_within(const PanoramaView& view, const PixelRect& bounds, const PixelRect& rect,
                           RadianceImage* ret_pixels, const std::function<bool()>& cancelled);

  const Renderer& renderer_;
  std::vector<Denoiser> denoisers_;  ///< One for each thread.
  Film film_;
  RadianceImage wide_;
};

}  // namespace cyclorama
