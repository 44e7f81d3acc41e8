// SPDX-License-Identifier: Apache-2.0
/// Renders denoised pictures of a scene: traces the requested rect and a margin, denoises, and crops.
///
/// The margin is Denoiser::halo_px() on each side within the picture, and whole cells of 16x16 pixels are traced, so a
/// small rect costs more per pixel than a large one. Pixels are bit-identical to those of the whole picture. In stereo,
/// each eye's picture is denoised without data from the other.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "renderfarm/denoise/denoise.h"
#include "renderfarm/render/renderer.h"

namespace cyclorama::denoise {

/// Checks that a view can be denoised. Errors: kInvalidArgument, one sentence, for a stereo picture whose eyes are not
/// separated at a multiple of kCutPx pixels.
[[nodiscard]] Status check_denoisable(const render::PanoramaView& view);

/// The finished part of a rect, with which an interrupted rendering continues. Movable. Must be used with only one
/// DenoisingRenderer, and always with the same view and rect.
class UnfinishedPicture {
 public:
  [[nodiscard]] bool is_done() const { return done_; }

 private:
  friend class DenoisingRenderer;
  /// The part of the rect that is in one eye's picture.
  struct Part {
    render::Film film;   ///< Sum of the finished pieces of samples.
    render::Film piece;  ///< Film of the current piece.
    int samples = 0;     ///< Number of samples per pixel in `film`.
    PixelRays rays;
    RadianceImage wide;
    std::vector<std::uint8_t> strips;  ///< 1 for each denoised strip.
    bool is_done = false;
  };
  std::array<Part, 2> parts_;
  bool done_ = false;
};

/// Renders and denoises. Reuses its memory for successive pictures. Keeps a reference to the renderer, which must
/// outlive it. Thread-safe: several threads may render pictures of their own.
class DenoisingRenderer {
 public:
  /// Denoises with the renderer's threads. Pixels do not depend on their number.
  explicit DenoisingRenderer(const render::Renderer& renderer) : renderer_(renderer) {}

  /// Like the functions of Renderer with the same names. The cost includes the margin and the filter; depth is not
  /// filtered. Precondition: check_view() and check_denoisable() accept the view.
  render::RenderCost render(const render::PanoramaView& view, const PixelRect& rect, RgbImage* ret_pixels,
                            const std::function<bool()>& cancelled, InverseDepthImage* ret_depth = nullptr);
  render::RenderCost render_radiance(const render::PanoramaView& view, const PixelRect& rect, RadianceImage* ret_pixels,
                                     const std::function<bool()>& cancelled, InverseDepthImage* ret_depth = nullptr);

  /// Continues `picture` until it is done or `stop` returns true. `stop` is called before each cell and each strip of
  /// the filter, which take some milliseconds each, from any thread. No work is repeated, and pixels do not depend on
  /// interruptions. Returns the cost of this call. `ret_pixels`, which render::developed() turns into codes, and
  /// `ret_depth` are written once the picture is done.
  render::RenderCost advance(const render::PanoramaView& view, const PixelRect& rect, UnfinishedPicture* picture,
                             const std::function<bool()>& stop, RadianceImage* ret_pixels,
                             InverseDepthImage* ret_depth);

 private:
  /// The margin is clipped to `bounds`. Precondition: `rect` is inside `bounds`.
  render::RenderCost advance_within(const render::PanoramaView& view, const PixelRect& bounds, const PixelRect& rect,
                                    UnfinishedPicture::Part* part, const std::function<bool()>& stop,
                                    RadianceImage* ret_pixels, InverseDepthImage* ret_depth);
  /// Renders the rest of the film of `wide`, unless stopped.
  render::RenderCost trace(const render::PanoramaView& view, const PixelRect& wide, UnfinishedPicture::Part* part,
                           const std::function<bool()>& stop) const;
  /// Returns the directions of the pixels of `wide`, and adds the thread time to `cpu_seconds`.
  [[nodiscard]] PixelRays rays_of(const render::PanoramaView& view, const PixelRect& wide, double* cpu_seconds) const;
  /// Denoises the rest of `rect`, a part of `wide`, unless stopped. Returns the thread time.
  double denoise(const PixelRect& wide, const PixelRect& rect, UnfinishedPicture::Part* part,
                 const std::function<bool()>& stop);

  const render::Renderer& renderer_;
  tbb::enumerable_thread_specific<Denoiser> denoisers_;
};

}  // namespace cyclorama::denoise
