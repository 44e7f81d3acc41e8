// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/trade/trade_meter.h"

#include <time.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/clock.h"
#include "renderfarm/denoise/denoise.h"
#include "renderfarm/quality/enlarge.h"
#include "renderfarm/quality/light_error.h"
#include "renderfarm/render/tone.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama {
namespace {

/// A picture that takes less is rendered three times and the quickest run counts, since disturbances only add time.
constexpr double kShortCpuSeconds = 0.5;
constexpr int kRepeats = 3;
constexpr int kPieceSamples = 16;

Error cancelled_error() { return Error(ErrorCode::kUnavailable, "stopped before it was done"); }

/// Time of the whole process, and elapsed time, since construction.
class Stopwatch {
 public:
  [[nodiscard]] double cpu_seconds() const { return process_seconds() - cpu_; }
  [[nodiscard]] double wall_seconds() const { return to_seconds(SteadyClock().now() - wall_); }

 private:
  static double process_seconds() {
    timespec t{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  }
  double cpu_ = process_seconds();
  TimePoint wall_ = SteadyClock().now();
};

PixelRect whole(const Panorama& panorama) { return {0, 0, panorama.width_px, panorama.height_px}; }

}  // namespace

Panorama scaled(Panorama panorama, double scale) {
  panorama.width_px = std::max(1, static_cast<int>(std::lround(scale * panorama.width_px)));
  panorama.height_px = std::max(1, static_cast<int>(std::lround(scale * panorama.height_px)));
  return panorama;
}

TradeMeter::TradeMeter(const render::Renderer& renderer, render::PanoramaView view, RadianceImage reference)
    : renderer_(renderer),
      view_(std::move(view)),
      reference_(std::move(reference)),
      shown_reference_(render::developed(reference_, renderer.scene().tone)) {
  CHECK(reference_.width() == view_.panorama.width_px && reference_.height() == view_.panorama.height_px);
}

Status TradeMeter::render(const render::PictureQuality& quality, const std::function<bool()>& cancelled) {
  const bool same_picture = !rendered_.codes.empty() && rendered_.quality.render == quality.render &&
                            rendered_.quality.scale == quality.scale && rendered_.quality.denoise == quality.denoise;
  if (same_picture) return Done{};
  render::PanoramaView view = view_;
  view.quality = quality.render;
  view.panorama = scaled(view.panorama, quality.scale);
  TRY(render::check_view(view, whole(view.panorama)));
  RadianceImage light;
  Rendered best;
  for (int i = 0; i < kRepeats; ++i) {
    render::Film film;
    render::RenderCost cost = renderer_.render_film(view, whole(view.panorama), quality.denoise, &film, cancelled);
    if (cancelled && cancelled()) return cancelled_error();
    const Stopwatch watch;
    light = quality.denoise
                ? denoise::denoised(film, denoise::panorama_rays(view.panorama, view.heading_rad, whole(view.panorama)))
                : film.mean();
    best.codes = render::developed(light, renderer_.scene().tone);
    cost.cpu_seconds += watch.cpu_seconds();
    cost.wall_seconds += watch.wall_seconds();
    if (i == 0 || cost.cpu_seconds < best.cost.cpu_seconds) best.cost = cost;
    if (cost.cpu_seconds > kShortCpuSeconds) break;
  }
  best.quality = quality;
  TRY_ASSIGN(best.relmse, quality::relative_squared_error(
                              quality::enlarged(light, reference_.width(), reference_.height()), reference_));
  rendered_ = std::move(best);
  return Done{};
}

Result<TradePoint> TradeMeter::measure(const PlannedPoint& planned, const std::function<bool()>& cancelled) {
  TRY(render(planned.quality, cancelled));
  const Stopwatch watch;
  TRY_ASSIGN(const std::vector<std::byte> jpeg,
             encoder_.encode(rendered_.codes, {planned.quality.jpeg_quality, planned.quality.subsample_chroma}));
  TradePoint point;
  point.planned = planned;
  point.cpu_s = rendered_.cost.cpu_seconds + watch.cpu_seconds();
  point.wall_s = rendered_.cost.wall_seconds + watch.wall_seconds();
  point.rays = rendered_.cost.rays;
  point.bytes = jpeg.size();
  point.removed_light = rendered_.cost.removed_light;
  point.relmse = rendered_.relmse;
  TRY_ASSIGN(const RgbImage decoded, decoder_.decode(jpeg, rendered_.codes.data().size()));
  TRY_ASSIGN(point.shown, quality::shown_error(quality::enlarged(decoded, reference_.width(), reference_.height()),
                                               shown_reference_));
  return point;
}

Result<render::Film> converged_film(const render::Renderer& renderer, const render::PanoramaView& view,
                                    const std::function<void(double)>& progress,
                                    const std::function<bool()>& cancelled) {
  TRY(render::check_view(view, whole(view.panorama)));
  render::Film film(view.panorama.width_px, view.panorama.height_px, false);
  render::PanoramaView part = view;
  part.quality.sequence = view.quality.samples;
  for (int first = 0; first < view.quality.samples; first += kPieceSamples) {
    part.quality.first_sample = first;
    part.quality.samples = std::min(kPieceSamples, view.quality.samples - first);
    render::Film piece;
    renderer.render_film(part, whole(view.panorama), false, &piece, cancelled);
    if (cancelled && cancelled()) return cancelled_error();
    film.add(piece);
    progress(static_cast<double>(first + part.quality.samples) / view.quality.samples);
  }
  return film;
}

double own_relmse(const render::Film& film) {
  const RadianceImage mean = film.mean();
  const render::ScalarImage variance = film.variance();
  double sum = 0.0;
  for (std::size_t i = 0; i < variance.data().size(); ++i) {
    const auto light = static_cast<double>(mean.data()[3 * i + 1]);  // Green dominates the luminance.
    sum += static_cast<double>(variance.data()[i]) / (light * light + quality::kRelativeErrorFloor);
  }
  return sum / static_cast<double>(variance.data().size());
}

}  // namespace cyclorama
