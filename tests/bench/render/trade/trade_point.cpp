// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/trade/trade_point.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "tests/bench/render/trade/plot.h"

namespace cyclorama {
namespace {

bool sent_as_base(const render::PictureQuality& quality) {
  const render::PictureQuality base = trade_base();
  return quality.jpeg_quality == base.jpeg_quality && quality.subsample_chroma == base.subsample_chroma;
}

struct Axis {
  std::string label;
  double (*value)(const TradePoint&);
};

/// `is_time`: x is time; the Pareto front is a line only there.
Plot panel(const std::vector<TradePoint>& points, const governor::ParetoFront& front, const Axis& x, const Axis& y,
           bool is_time) {
  // Okabe and Ito's palette, distinguishable by colour-blind people.
  static constexpr struct {
    const char* knob;
    const char* colour;
  } kKnobs[] = {{"samples", "#0072b2"},  {"bounces", "#009e73"},       {"scale", "#d55e00"},
                {"denoiser", "#cc79a7"}, {"light samples", "#e69f00"}, {"firefly limit", "#8c510a"},
                {"adaptive", "#56b4e9"}, {"jpeg", "#888888"}};
  Plot plot{x.label, y.label, {}};
  const auto add = [&](PlotSeries series, const auto& is_part) {
    for (const TradePoint& point : points) {
      if (is_part(point)) series.points.push_back({x.value(point), y.value(point)});
    }
    std::ranges::sort(series.points);
    plot.series.push_back(std::move(series));
  };
  add({"together", "#c8c8c8", {}, false, 2.0},
      [](const TradePoint& point) { return point.planned.knob == "together"; });
  add({"front", "#000000", {}, is_time, 5.0}, [&](const TradePoint& point) { return is_on(front, point); });
  for (const auto& [knob, colour] : kKnobs) {
    add({knob, colour, {}, true, 3.0},
        [&](const TradePoint& point) { return point.planned.knob == knob || point.planned.knob == "base"; });
  }
  return plot;
}

}  // namespace

Result<governor::ParetoFront> trade_pareto_front(const std::vector<TradePoint>& points, double shown_px) {
  std::vector<governor::ParetoPoint> candidates;
  for (const TradePoint& point : points) {
    if (!sent_as_base(point.planned.quality)) continue;
    candidates.push_back({point.planned.quality, 1e6 * point.cpu_s / shown_px, point.relmse});
  }
  return governor::ParetoFront::make(std::move(candidates));
}

bool is_on(const governor::ParetoFront& front, const TradePoint& point) {
  for (std::size_t i = 0; i < front.size(); ++i) {
    if (front[i].quality == point.planned.quality) return true;
  }
  return false;
}

std::string trade_csv(const std::vector<TradePoint>& points, const governor::ParetoFront& front) {
  std::string text =
      "knob,samples,bounces,light_samples,firefly_limit,adaptive_error,scale,denoise,jpeg_quality,subsample_chroma,"
      "cpu_ms,wall_ms,rays,bytes,removed_light,relmse,psnr_db,ssim,flip,front\n";
  for (const TradePoint& point : points) {
    const render::PictureQuality& quality = point.planned.quality;
    const render::RenderQuality& render = quality.render;
    fmt::format_to(std::back_inserter(text),
                   "{},{},{},{},{},{},{},{:d},{},{:d},{:.3f},{:.3f},{},{},{:.3g},{:.6g},{:.3f},{:.5f},{:.5f},{:d}\n",
                   point.planned.knob, render.samples, render.bounces, render.light_samples, render.firefly_limit,
                   render.adaptive_error, quality.scale, quality.denoise, quality.jpeg_quality,
                   quality.subsample_chroma, 1e3 * point.cpu_s, 1e3 * point.wall_s, point.rays, point.bytes,
                   point.removed_light, point.relmse, point.shown.psnr_db, point.shown.ssim, point.shown.flip,
                   is_on(front, point));
  }
  return text;
}

std::string trade_svg(const std::vector<TradePoint>& points, const governor::ParetoFront& front,
                      const std::string& title) {
  const Axis cpu{"processor time of a picture, ms", [](const TradePoint& point) { return 1e3 * point.cpu_s; }};
  const Axis bytes{"bytes of a picture", [](const TradePoint& point) { return static_cast<double>(point.bytes); }};
  const Axis flip{"FLIP of what is shown", [](const TradePoint& point) { return point.shown.flip; }};
  const Axis relmse{"relMSE of the light", [](const TradePoint& point) { return point.relmse; }};
  return plot_svg(title, {panel(points, front, cpu, flip, true), panel(points, front, cpu, relmse, true),
                          panel(points, front, bytes, flip, false)});
}

}  // namespace cyclorama
