// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/trade/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace cyclorama {
namespace {

constexpr double kPanelPx = 380.0;  ///< Side of the square that contains the points.
constexpr double kLeftPx = 70.0;
constexpr double kTopPx = 44.0;
constexpr double kBottomPx = 58.0;
constexpr double kLegendPx = 140.0;

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '&') {
      result += "&amp;";
    } else if (c == '<') {
      result += "&lt;";
    } else {
      result += c;
    }
  }
  return result;
}

bool has_logarithm(double value) { return value > 0.0 && std::isfinite(value); }
bool is_drawn(const std::array<double, 2>& point) { return has_logarithm(point[0]) && has_logarithm(point[1]); }

/// A logarithmic axis from one round number to another: 1, 2 or 5 times a power of ten; long axes omit most labels.
class LogAxis {
 public:
  LogAxis(const Plot& plot, std::size_t coordinate) {
    double min = std::numeric_limits<double>::infinity();
    double max = 0.0;
    for (const PlotSeries& series : plot.series) {
      for (const auto& point : series.points) {
        if (!is_drawn(point)) continue;
        min = std::min(min, point[coordinate]);
        max = std::max(max, point[coordinate]);
      }
    }
    if (max == 0.0) min = max = 1.0;
    const int first = static_cast<int>(std::floor(std::log10(min))) - 1;
    const int last = static_cast<int>(std::ceil(std::log10(max))) + 1;
    constexpr int kShort = 5;  // Decades, including a spare one at each end; each has three labels.
    constexpr int kMaxLabels = 9;
    const int decades = last - first;
    const int stride = decades <= kShort + 2 ? 1 : (decades + kMaxLabels - 1) / kMaxLabels;
    std::vector<double> round;
    for (int decade = first - stride; decade <= last + stride; decade += stride) {
      round.push_back(std::pow(10.0, decade));
      if (decades > kShort + 2) continue;
      for (const double step : {2.0, 5.0}) round.push_back(step * std::pow(10.0, decade));
    }
    const auto above = std::ranges::upper_bound(round, max);
    const auto below = std::ranges::lower_bound(round, min) - 1;
    ticks_.assign(below, above + 1);
  }
  [[nodiscard]] const std::vector<double>& ticks() const { return ticks_; }
  /// Returns 0 at the first tick, 1 at the last.
  [[nodiscard]] double place(double value) const {
    return std::log(value / ticks_.front()) / std::log(ticks_.back() / ticks_.front());
  }

 private:
  std::vector<double> ticks_;
};

class Canvas {
 public:
  explicit Canvas(double left) : left_(left) {}
  void draw(const Plot& plot);
  [[nodiscard]] const std::string& svg() const { return svg_; }

 private:
  template <typename... Args>
  void put(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(svg_), format, std::forward<Args>(args)...);
  }
  void draw_axes(const Plot& plot, const LogAxis& x, const LogAxis& y);
  void draw_series(const PlotSeries& series, const LogAxis& x, const LogAxis& y);
  [[nodiscard]] double u(double place) const { return left_ + place * kPanelPx; }
  [[nodiscard]] static double v(double place) { return kTopPx + (1.0 - place) * kPanelPx; }

  double left_;
  std::string svg_;
};

void Canvas::draw(const Plot& plot) {
  const LogAxis x(plot, 0);
  const LogAxis y(plot, 1);
  draw_axes(plot, x, y);
  for (const PlotSeries& series : plot.series) draw_series(series, x, y);
}

void Canvas::draw_axes(const Plot& plot, const LogAxis& x, const LogAxis& y) {
  for (const double tick : x.ticks()) {
    const double at = u(x.place(tick));
    put("<path d='M{:.1f} {:.1f}V{:.1f}' stroke='#e4e4e4'/>\n", at, v(0), v(1));
    put("<text x='{:.1f}' y='{:.1f}' text-anchor='middle'>{:g}</text>\n", at, v(0) + 16.0, tick);
  }
  for (const double tick : y.ticks()) {
    const double at = v(y.place(tick));
    put("<path d='M{:.1f} {:.1f}H{:.1f}' stroke='#e4e4e4'/>\n", u(0), at, u(1));
    put("<text x='{:.1f}' y='{:.1f}' text-anchor='end'>{:g}</text>\n", u(0) - 6.0, at + 4.0, tick);
  }
  put("<rect x='{:.1f}' y='{:.1f}' width='{}' height='{}' fill='none' stroke='#808080'/>\n", u(0), v(1), kPanelPx,
      kPanelPx);
  put("<text x='{:.1f}' y='{:.1f}' text-anchor='middle'>{}</text>\n", u(0.5), v(0) + 38.0, escaped(plot.x_label));
  put("<text x='{:.1f}' y='{:.1f}' font-weight='bold'>{}</text>\n", u(0), v(1) - 8.0, escaped(plot.y_label));
}

void Canvas::draw_series(const PlotSeries& series, const LogAxis& x, const LogAxis& y) {
  std::string path;
  for (const auto& point : series.points) {
    if (!is_drawn(point)) continue;
    const double at_u = u(x.place(point[0]));
    const double at_v = v(y.place(point[1]));
    put("<circle cx='{:.1f}' cy='{:.1f}' r='{}' fill='{}'/>\n", at_u, at_v, series.radius_px, series.colour);
    path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? 'M' : 'L', at_u, at_v);
  }
  if (series.joined && !path.empty()) {
    put("<path d='{}' fill='none' stroke='{}' stroke-width='1.5'/>\n", path, series.colour);
  }
}

std::string legend(const Plot& plot, double left) {
  std::string svg;
  double top = kTopPx + 10.0;
  for (const PlotSeries& series : plot.series) {
    svg += fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='4' fill='{}'/><text x='{:.1f}' y='{:.1f}'>{}</text>\n", left,
                       top, series.colour, left + 10.0, top + 4.0, escaped(series.name));
    top += 20.0;
  }
  return svg;
}

}  // namespace

std::string plot_svg(const std::string& title, const std::vector<Plot>& panels) {
  constexpr double kStridePx = kLeftPx + kPanelPx;
  const double width = kStridePx * static_cast<double>(panels.size()) + kLegendPx;
  const double height = kTopPx + kPanelPx + kBottomPx;
  std::string svg = fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' width='{0}' height='{1}' viewBox='0 0 {0} {1}' font-family='sans-serif' "
      "font-size='11'>\n<rect width='100%' height='100%' fill='white'/>\n<text x='{2}' y='18' "
      "font-size='14'>{3}</text>\n",
      width, height, kLeftPx, escaped(title));
  for (std::size_t i = 0; i < panels.size(); ++i) {
    Canvas canvas(kLeftPx + kStridePx * static_cast<double>(i));
    canvas.draw(panels[i]);
    svg += canvas.svg();
  }
  if (!panels.empty()) svg += legend(panels.front(), width - kLegendPx + 20.0);
  return svg + "</svg>\n";
}

}  // namespace cyclorama
