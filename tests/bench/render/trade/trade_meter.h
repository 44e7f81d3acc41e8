// SPDX-License-Identifier: Apache-2.0
/// Makes a picture at one setting the way the farm does, and measures what it cost and how wrong it is.
#pragma once

#include <functional>

#include "common/image/jpeg.h"
#include "renderfarm/render/renderer.h"
#include "tests/bench/render/trade/trade_point.h"

namespace cyclorama {

/// The same field in `scale` times as many pixels each way.
[[nodiscard]] Panorama scaled(Panorama panorama, double scale);

/// Of one view of one scene. Keeps a reference to the renderer, which must outlive it. Thread-bound.
class TradeMeter {
 public:
  /// `reference` is exposed light in the size of the view's panorama; the view's quality is not used.
  TradeMeter(const Renderer& renderer, PanoramaView view, RadianceImage reference);

  /// kUnavailable  cancelled.     kBadData  a pixel is not finite.
  Result<TradePoint> measure(const PlannedPoint& planned, const std::function<bool()>& cancelled);

 private:
  /// What is the same for all settings that differ in how the picture is sent.
  struct Rendered {
    PictureQuality quality;
    RenderCost cost;  ///< With the denoiser, up to tone mapping.
    RgbImage codes;   ///< In the size in which it was rendered.
    double relmse = 0.0;
  };
  Status render(const PictureQuality& quality, const std::function<bool()>& cancelled);

  const Renderer& renderer_;
  PanoramaView view_;
  RadianceImage reference_;
  RgbImage shown_reference_;
  JpegEncoder encoder_;
  JpegDecoder decoder_;
  Rendered rendered_;
};

/// Samples [0, samples) of a view, as a sum of short films, so that it can be stopped and seen to progress.
/// kUnavailable  cancelled.
Result<Film> converged_film(const Renderer& renderer, const PanoramaView& view,
                            const std::function<void(double)>& progress, const std::function<bool()>& cancelled);

/// What the film's mean still lacks: its relMSE, as far as its samples' scatter tells (an overestimate: they are
/// stratified).
[[nodiscard]] double own_relmse(const Film& film);

}  // namespace cyclorama
