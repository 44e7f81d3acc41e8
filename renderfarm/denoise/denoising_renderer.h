// SPDX-License-Identifier: Apache-2.0
/// Renders denoised pictures of a scene: traces with a margin, denoises, and crops to the requested rect.
///
/// The margin is Denoiser::halo_px() on each side within the picture, traced in whole cells of 16x16 pixels, so a small
/// rect costs more per pixel than a large one. Pixels equal those of the whole picture to the last bit. In stereo, each
/// eye's picture is denoised by itself, without data from the other.
#pragma once

#include <vector>

#include "renderfarm/denoise/denoise.h"
#include "renderfarm/render/renderer.h"

namespace cyclorama::denoise {

/// Errors: kInvalidArgument, in one sentence, for a stereo picture whose eyes are not separated at a multiple of kCutPx
/// pixels.
[[nodiscard]] Status check_denoisable(const render::PanoramaView& view);

/// Renders and denoises. Keeps its memory from one picture to the next, and a reference to the renderer, which must
/// outlive it. Thread-bound.
class DenoisingRenderer {
 public:
  /// Denoises with `threads` threads (0: one per core); pixels do not depend on their number.
  DenoisingRenderer(const render::Renderer& renderer, int threads);

  /// Like the Renderer functions of the same name; the cost includes the margin and the filter. Precondition:
  /// check_view() and check_denoisable(). The filter leaves depth alone.
  render::RenderCost render(const render::PanoramaView& view, const PixelRect& rect, RgbImage* ret_pixels,
                            const std::function<bool()>& cancelled, InverseDepthImage* ret_depth = nullptr);
  render::RenderCost render_radiance(const render::PanoramaView& view, const PixelRect& rect, RadianceImage* ret_pixels,
                                     const std::function<bool()>& cancelled, InverseDepthImage* ret_depth = nullptr);

 private:
  /// Precondition: `rect` lies inside `bounds`, to which the margin is clipped.
  render::RenderCost render_within(const render::PanoramaView& view, const PixelRect& bounds, const PixelRect& rect,
                                   RadianceImage* ret_pixels, const std::function<bool()>& cancelled,
                                   InverseDepthImage* ret_depth);

  const render::Renderer& renderer_;
  std::vector<Denoiser> denoisers_;  ///< One per thread.
  render::Film film_;
  RadianceImage wide_;
};

}  // namespace cyclorama::denoise
