// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/markerless/silhouette.h"

#include <algorithm>
#include <cmath>

namespace cyclorama::tracker {
namespace {

constexpr double kMinScore = 0.35;
/// Distance from the head's top down to the hip, in head widths: 0.47 of an adult's height, whose head is 0.155 m wide.
constexpr double kHipBelow = 5.2;
/// First and last row in which the chest is measured, in head widths below the head's top.
constexpr double kChestFrom = 2.1;
constexpr double kChestTo = 3.9;
/// First and last row in which the head is measured, near its maximum width, in head widths below its top.
constexpr double kHeadFrom = 0.3;
constexpr double kHeadTo = 0.95;

double score_at(const SummedShare& share, double u, double top, double w) {
  const double head = share.mean(u - 0.38 * w, top + 0.1 * w, u + 0.38 * w, top + 1.15 * w);
  if (head < 0.5) return 0.0;
  const double chest = share.mean(u - 0.9 * w, top + 1.8 * w, u + 0.9 * w, top + 2.7 * w);
  if (chest < 0.4) return 0.0;
  const double above = 1.0 - share.mean(u - 0.5 * w, top - 0.4 * w, u + 0.5 * w, top - 0.06 * w);
  const double left = 1.0 - share.mean(u - 1.15 * w, top, u - 0.62 * w, top + 0.95 * w);
  const double right = 1.0 - share.mean(u + 0.62 * w, top, u + 1.15 * w, top + 0.95 * w);
  // A person behind may occupy one side.
  const double sides = 0.65 * std::max(left, right) + 0.35 * std::min(left, right);
  return head * std::min(1.0, 1.1 * chest) * above * sides;
}

void climb(const SummedShare& share, HeadCandidate* position) {
  double step = 0.25;
  while (step > 0.03) {
    HeadCandidate best = *position;
    for (const double du : {-step, 0.0, step}) {
      for (const double dv : {-step, 0.0, step}) {
        for (const double grow : {1.0 - 0.3 * step, 1.0, 1.0 + 0.3 * step}) {
          const double u = position->u + du * position->width;
          const double top = position->top + dv * position->width;
          const double score = score_at(share, u, top, grow * position->width);
          if (score > best.score) best = {u, top, grow * position->width, score};
        }
      }
    }
    if (best.score <= position->score) step *= 0.5;
    *position = best;
  }
}

struct Span {
  double left = 0.0;
  double right = 0.0;
  bool left_ends = false;  ///< True if the silhouette ends there; false at another person or the picture's border.
  bool right_ends = false;
};

/// Returns the silhouette's end from (x, y) outwards, to fractions of a cell: the outermost cell counts by its share of
/// the contrast inside.
double edge(const Silhouette& silhouette, int x, int y, int step, int max, bool* ret_ends) {
  const auto inside = [&](int at) { return at >= 0 && at < silhouette.share.width(); };
  int gap = 0;
  int last = x;
  for (int i = 0; i <= max; ++i) {
    const int at = x + step * i;
    if (!inside(at)) break;
    if (*silhouette.share.at(at, y) > 0.5f) {
      last = at;
      gap = 0;
    } else if (++gap > 2) {
      *ret_ends = true;
      break;
    }
  }
  const int before = last - step, two = last - 2 * step, next = last + step;
  double beyond = 1.0;
  if (inside(before) && inside(two)) {
    const double full = 0.5 * (double{*silhouette.contrast.at(before, y)} + double{*silhouette.contrast.at(two, y)});
    if (full > 1.0) {
      beyond = std::clamp(double{*silhouette.contrast.at(last, y)} / full, 0.0, 1.0);
      if (inside(next) && *ret_ends) beyond += std::clamp(double{*silhouette.contrast.at(next, y)} / full, 0.0, 1.0);
    }
  }
  return step > 0 ? last + beyond : last + 1.0 - beyond;
}

std::optional<Span> span_at(const Silhouette& silhouette, double u, int y, double reach) {
  if (y < 0 || y >= silhouette.share.height()) return std::nullopt;
  const int x = static_cast<int>(std::floor(u));
  if (x < 0 || x >= silhouette.share.width() || *silhouette.share.at(x, y) < 0.5f) return std::nullopt;
  Span span;
  const int max = static_cast<int>(std::ceil(reach));
  span.left = edge(silhouette, x, y, -1, max, &span.left_ends);
  span.right = edge(silhouette, x, y, 1, max, &span.right_ends);
  return span;
}

/// Returns the sum of Silhouette::outline over the three cells around an edge.
double outline_at(const Silhouette& silhouette, double u, int y) {
  double sum = 0.0;
  for (int x = static_cast<int>(std::floor(u)) - 1; x <= static_cast<int>(std::floor(u)) + 1; ++x) {
    if (x >= 0 && x < silhouette.outline.width()) sum += double{*silhouette.outline.at(x, y)};
  }
  return sum;
}

struct Spread {
  double median = 0.0;
  double deviation = 0.0;  ///< Standard deviation of the median.
};
std::optional<Spread> spread_of(std::vector<double> values) {
  if (values.size() < 3) return std::nullopt;
  const auto middle = [](std::vector<double>* v) {
    std::sort(v->begin(), v->end());
    return 0.5 * ((*v)[v->size() / 2] + (*v)[(v->size() - 1) / 2]);
  };
  Spread spread;
  spread.median = middle(&values);
  const auto count = static_cast<double>(values.size());
  for (double& value : values) value = std::abs(value - spread.median);
  // 1.4826 converts the median of differences to a deviation, 1.2533 converts the deviation of a mean to that of a
  // median. Adjacent rows have correlated errors: every second one counts.
  spread.deviation = 1.4826 * 1.2533 * middle(&values) / std::sqrt(0.5 * count);
  return spread;
}

}  // namespace

SummedShare::SummedShare(const Image<float, 1>& share)
    : width_(share.width()),
      height_(share.height()),
      sums_(static_cast<std::size_t>(share.width() + 1) * static_cast<std::size_t>(share.height() + 1), 0.0) {
  const auto row = static_cast<std::size_t>(width_ + 1);
  for (int y = 0; y < height_; ++y) {
    double sum = 0.0;
    for (int x = 0; x < width_; ++x) {
      sum += double{*share.at(x, y)};
      const std::size_t i = (static_cast<std::size_t>(y) + 1) * row + static_cast<std::size_t>(x) + 1;
      sums_[i] = sums_[i - row] + sum;
    }
  }
}

double SummedShare::mean(double left, double top, double right, double bottom) const {
  // Uses those whole cells whose middle is inside.
  const int x0 = static_cast<int>(std::lround(left)), x1 = std::max(x0 + 1, static_cast<int>(std::lround(right)));
  const int y0 = static_cast<int>(std::lround(top)), y1 = std::max(y0 + 1, static_cast<int>(std::lround(bottom)));
  const double all = static_cast<double>(x1 - x0) * static_cast<double>(y1 - y0);
  const int l = std::clamp(x0, 0, width_), r = std::clamp(x1, 0, width_);
  const int t = std::clamp(y0, 0, height_), b = std::clamp(y1, 0, height_);
  const auto at = [&](int x, int y) {
    return sums_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_ + 1) + static_cast<std::size_t>(x)];
  };
  return (at(r, b) - at(l, b) - at(r, t) + at(l, t)) / all;
}

std::optional<HeadCandidate> find_head_near(const SummedShare& share, const HeadCandidate& near) {
  HeadCandidate best;
  for (double du = -1.0; du <= 1.0; du += 0.25) {
    for (double dv = -1.0; dv <= 1.0; dv += 0.25) {
      for (const double grow : {0.85, 1.0, 1.18}) {
        const HeadCandidate position{near.u + du * near.width, near.top + dv * near.width, grow * near.width, 0.0};
        const double score = score_at(share, position.u, position.top, position.width);
        if (score > best.score) best = {position.u, position.top, position.width, score};
      }
    }
  }
  if (best.score < 0.6 * kMinScore) return std::nullopt;
  climb(share, &best);
  if (best.score < kMinScore) return std::nullopt;
  return best;
}

std::vector<HeadCandidate> find_heads(const SummedShare& share, double min, double max) {
  std::vector<HeadCandidate> found;
  for (double width = std::max(min, 3.0); width <= max; width *= 1.2) {
    const double step = std::max(1.0, 0.25 * width);
    for (double top = 0.0; top + 2.0 * width < share.height(); top += step) {
      for (double u = 0.5 * width; u + 0.5 * width < share.width(); u += step) {
        const double score = score_at(share, u, top, width);
        if (score > 0.6 * kMinScore) found.push_back({u, top, width, score});
      }
    }
  }
  const auto better = [](const HeadCandidate& a, const HeadCandidate& b) { return a.score > b.score; };
  std::sort(found.begin(), found.end(), better);
  std::vector<HeadCandidate> kept;
  for (HeadCandidate& position : found) {
    if (kept.size() >= 6) break;
    const auto taken = [&](const HeadCandidate& other) {
      const double reach = 1.3 * std::max(position.width, other.width);
      return std::abs(position.u - other.u) < reach && std::abs(position.top - other.top) < 2.5 * reach;
    };
    if (std::any_of(kept.begin(), kept.end(), taken)) continue;
    climb(share, &position);
    if (position.score >= kMinScore) kept.push_back(position);
  }
  std::sort(kept.begin(), kept.end(), better);
  return kept;
}

std::optional<BodyShape> measured(const Silhouette& silhouette, const HeadCandidate& start) {
  BodyShape shape;
  HeadCandidate head = start;
  for (int pass = 0; pass < 2; ++pass) {
    std::vector<double> widths, middles;
    double outline = 0.0;
    const int to = static_cast<int>(std::ceil(head.top + kHeadTo * head.width));
    for (int y = static_cast<int>(std::floor(head.top + kHeadFrom * head.width)); y < to; ++y) {
      const auto span = span_at(silhouette, head.u, y, 1.1 * head.width);
      if (!span || !span->left_ends || !span->right_ends) continue;
      const double width = span->right - span->left;
      if (width < 0.5 * head.width || width > 1.7 * head.width) continue;
      widths.push_back(width);
      middles.push_back(0.5 * (span->left + span->right));
      for (const double u : {span->left, span->right}) outline += outline_at(silhouette, u, y);
    }
    const auto width = spread_of(widths);
    const auto middle = spread_of(middles);
    if (!width || !middle) return std::nullopt;
    head.width = width->median;
    head.u = middle->median;
    shape.width_deviation = std::hypot(width->deviation, 0.12);
    shape.outline = outline / static_cast<double>(2 * widths.size());
  }
  std::vector<double> middles, chests, rows;
  const int to = static_cast<int>(std::ceil(head.top + kChestTo * head.width));
  for (int y = static_cast<int>(std::floor(head.top + kChestFrom * head.width)); y < to; ++y) {
    const auto span = span_at(silhouette, head.u, y, 2.4 * head.width);
    if (!span || !span->left_ends || !span->right_ends) continue;
    middles.push_back(0.5 * (span->left + span->right));
    chests.push_back(span->right - span->left);
    rows.push_back(y + 0.5);
  }
  shape.head = head;
  shape.hip_u = head.u;
  shape.hip_deviation = head.width;  // Range of people's leans, since the hip could not be measured.
  shape.lean_deviation = 0.2;
  const auto chest = spread_of(middles);
  const auto chest_width = spread_of(chests);
  if (!chest || !chest_width) return shape;
  const double below = 0.5 * (rows.front() + rows.back()) - (head.top + 0.62 * head.width);
  if (below < head.width) return shape;
  shape.has_chest = true;
  shape.chest_width = chest_width->median;
  shape.chest_width_deviation = std::hypot(chest_width->deviation, 0.2);
  const double off = chest->median - head.u;
  const double off_deviation = std::hypot(chest->deviation, 0.15);
  shape.lean_rad = std::atan2(off, below);
  shape.lean_deviation = off_deviation / below;
  // Continues the line from the chest down to the hip.
  const double further = kHipBelow * head.width - (0.5 * (rows.front() + rows.back()) - head.top);
  shape.hip_u = chest->median + off / below * further;
  shape.hip_deviation = off_deviation * (1.0 + further / below);
  return shape;
}

}  // namespace cyclorama::tracker
