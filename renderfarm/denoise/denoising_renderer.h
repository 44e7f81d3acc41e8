// SPDX-License-Identifier: Apache-2.0
/// Renders denoised pictures of a scene: traces with a margin, denoises, and crops to the requested rect.
///
/// The margin is Denoiser::halo_px() on each side within the picture, traced in whole cells of 16x16 pixels, so a small
/// rect costs more per pixel than a large one. Pixels equal those of the whole picture to the last bit. In stereo, each
/// eye's picture is denoised by itself, without data from the other.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "renderfarm/denoise/denoise.h"
#include "renderfarm/render/renderer.h"

namespace cyclorama::denoise {

/// Errors: kInvalidArgument, in one sentence, for a stereo picture whose eyes are not separated at a multiple of kCutPx
/// pixels.
[[nodiscard]] Status check_denoisable(const render::PanoramaView& view);

/// The finished parts of a rect, so that rendering can be interrupted and continued. Movable; of one DenoisingRenderer call
/// sequence, always with the same view and rect.
class UnfinishedPicture {
 public:
  [[nodiscard]] bool is_done() const { return done_; }

 private:
  friend class DenoisingRenderer;
  /// The part that lies in one eye's picture.
  struct Part {
    render::Film film;   ///< Finished pieces of samples.
    render::Film piece;  ///< The current one.
    int samples = 0;     ///< Per pixel, in `film`.
    PixelRays rays;
    RadianceImage wide;
    std::vector<std::uint8_t> strips;  ///< 1 for each strip that is denoised.
    bool is_done = false;
  };
  std::array<Part, 2> parts_;
  bool done_ = false;
};

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

  /// Continues `picture` until it is done or `stop` returns true, which is called before each cell and each strip of the
  /// filter, from any thread; both take some milliseconds. Nothing is done twice, and pixels do not depend on the
  /// interruptions. Returns the cost of this call. `ret_pixels` and `ret_depth` are written when the picture is done.
  render::RenderCost advance(const render::PanoramaView& view, const PixelRect& rect, UnfinishedPicture* picture,
                             const std::function<bool()>& stop, RgbImage* ret_pixels, InverseDepthImage* ret_depth);

 private:
  render::RenderCost advance_radiance(const render::PanoramaView& view, const PixelRect& rect,
                                      UnfinishedPicture* picture, const std::function<bool()>& stop,
                                      RadianceImage* ret_pixels, InverseDepthImage* ret_depth);
  /// Precondition: `rect` lies inside `bounds`, to which the margin is clipped.
  render::RenderCost advance_within(const render::PanoramaView& view, const PixelRect& bounds, const PixelRect& rect,
                                    UnfinishedPicture::Part* part, const std::function<bool()>& stop,
                                    RadianceImage* ret_pixels, InverseDepthImage* ret_depth);
  /// Completes the film of `wide`, unless stopped.
  render::RenderCost trace(const render::PanoramaView& view, const PixelRect& wide, UnfinishedPicture::Part* part,
                           const std::function<bool()>& stop) const;
  /// Denoises what is left of `rect`, a part of `wide`, unless stopped. Returns the thread time.
  double denoise(const PixelRect& wide, const PixelRect& rect, UnfinishedPicture::Part* part,
                 const std::function<bool()>& stop);

  const render::Renderer& renderer_;
  std::vector<Denoiser> denoisers_;  ///< One per thread.
};

}  // namespace cyclorama::denoise
