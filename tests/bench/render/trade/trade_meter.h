// SPDX-License-Identifier: Apache-2.0
/// Renders a picture with one setting as the farm does, and measures its cost and its error.
#pragma once

#include <functional>

#include "common/image/jpeg.h"
#include "renderfarm/render/renderer.h"
#include "tests/bench/render/trade/trade_point.h"

namespace cyclorama {

/// The same field with `scale` times as many pixels in each direction.
[[nodiscard]] Panorama scaled(Panorama panorama, double scale);

/// Measures one view of one scene. Keeps a reference to the renderer, which must outlive it. Thread-bound.
class TradeMeter {
 public:
  /// `reference` is exposed light at the size of the view's panorama; the view's quality is not used.
  TradeMeter(const render::Renderer& renderer, render::PanoramaView view, RadianceImage reference);

  /// Errors: kUnavailable if cancelled; kBadData if a pixel is not finite.
  Result<TradePoint> measure(const PlannedPoint& planned, const std::function<bool()>& cancelled);

 private:
  /// Results shared by settings that differ only in the coding of the picture.
  struct Rendered {
    render::PictureQuality quality;
    render::RenderCost cost;  ///< Including the denoiser, up to tone mapping.
    RgbImage codes;           ///< At the rendered size.
    double relmse = 0.0;
  };
  Status render(const render::PictureQuality& quality, const std::function<bool()>& cancelled);

  const render::Renderer& renderer_;
  render::PanoramaView view_;
  RadianceImage reference_;
  RgbImage shown_reference_;
  JpegEncoder encoder_;
  JpegDecoder decoder_;
  Rendered rendered_;
};

/// Renders samples [0, samples) of a view as a sum of short films, so that it can be cancelled and report progress.
/// Errors: kUnavailable if cancelled.
Result<render::Film> converged_film(const render::Renderer& renderer, const render::PanoramaView& view,
                                    const std::function<void(double)>& progress,
                                    const std::function<bool()>& cancelled);

/// Remaining relMSE of the film's mean, estimated from the variance of its samples (an overestimate, since they are
/// stratified).
[[nodiscard]] double own_relmse(const render::Film& film);

}  // namespace cyclorama
