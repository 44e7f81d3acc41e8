// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/balance/cost_map.h"

#include <algorithm>
#include <cmath>

#include "renderfarm/balance/tiles.h"

namespace cyclorama::balance {
namespace {

/// Seconds per pixel before anything is measured: one or two samples on one core.
constexpr double kFirstGuess = 1e-6;
/// Lower bound of a cell's cost relative to the mean; if cells could cost nothing, a block could grow over any number
/// of them.
constexpr double kMinRelativeCost = 0.01;
constexpr double kStill_m = 1e-4;

double usable(double value, double otherwise) { return std::isfinite(value) && value > 0.0 ? value : otherwise; }
double usable_effort(double effort) { return std::clamp(usable(effort, 1.0), 1e-6, 1e6); }

/// Multiplies each cell by `factor` and by its number of pixels.
void to_work(WorkGrid* cost_per_px, double factor) {
  for (int y = 0; y < cost_per_px->rows(); ++y) {
    const auto row = static_cast<float>(factor * cost_per_px->height_px(y));
    for (int x = 0; x < cost_per_px->columns(); ++x) {
      cost_per_px->at(x, y) *= row * static_cast<float>(cost_per_px->width_px(x));
    }
  }
}
void to_cost_per_px(WorkGrid* work, double factor) {
  for (int y = 0; y < work->rows(); ++y) {
    const auto row = static_cast<float>(factor * work->height_px(y));
    for (int x = 0; x < work->columns(); ++x) work->at(x, y) /= row * static_cast<float>(work->width_px(x));
  }
}

/// The two cells whose centres are on both sides of a position, for linear interpolation. Positions are in cells from
/// the edge.
struct Between {
  int first = 0;
  int second = 0;
  float t = 0.0f;  ///< Weight of `second`.
};
Between between(double place, int cells) {
  const double from = std::clamp(place - 0.5, 0.0, cells - 1.0);
  const int first = static_cast<int>(from);
  return {first, std::min(first + 1, cells - 1), static_cast<float>(from - first)};
}

/// Raises each cell, NaN included, to at least kMinRelativeCost of the mean. Returns false if there is no cost at all.
bool mend(WorkGrid* cost) {
  const double mean = cost->total() / static_cast<double>(cost->cells().size());
  if (!(mean > 0.0 && std::isfinite(mean))) return false;
  const auto min = static_cast<float>(kMinRelativeCost * mean);
  for (float& cell : cost->cells()) cell = std::max(cell, min);
  return true;
}

/// Returns `stacked` if it divides the rows of cells evenly, else 1.
int usable_stack(PictureSize size, int stacked) {
  return stacked > 1 && size.height % (stacked * kCutPx) == 0 ? stacked : 1;
}

/// Distributes `part` of each cell's cost evenly over the cell and its neighbours in the same stacked picture.
WorkGrid spread(const WorkGrid& cost, double part, int stacked) {
  WorkGrid rows(cost.size());  // Sums of three cells along each row.
  const int last_x = cost.columns() - 1;
  const int last_y = cost.rows() - 1;
  const int of_one = std::max(cost.rows() / stacked, 1);
  for (int y = 0; y <= last_y; ++y) {
    for (int x = 0; x <= last_x; ++x) {
      rows.at(x, y) = cost.at(std::max(x - 1, 0), y) + cost.at(x, y) + cost.at(std::min(x + 1, last_x), y);
    }
  }
  WorkGrid out(cost.size());
  const auto own = static_cast<float>(1.0 - part);
  const auto ninth = static_cast<float>(part / 9.0);
  for (int y = 0; y <= last_y; ++y) {
    const int first = y / of_one * of_one;
    const int above = std::max(y - 1, first);
    const int below = std::min(y + 1, first + of_one - 1);
    for (int x = 0; x <= last_x; ++x) {
      out.at(x, y) = own * cost.at(x, y) + ninth * (rows.at(x, above) + rows.at(x, y) + rows.at(x, below));
    }
  }
  return out;
}

double difference(const WorkGrid& a, const WorkGrid& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.cells().size(); ++i) {
    // A cell that was not measured is skipped.
    if (std::isfinite(b.cells()[i])) sum += std::abs(a.cells()[i] - b.cells()[i]);
  }
  return sum;
}

}  // namespace

double CostMap::turn_seen(const Place& at, double part) const {
  const double turn = options_.turns && azimuth_span_rad_ > 0.0
                          ? part * (at.heading_rad - place_.heading_rad) / azimuth_span_rad_
                          : 0.0;
  return std::isfinite(turn) ? std::clamp(turn, -1.0, 1.0) : 0.0;
}

WorkGrid CostMap::moved(double fraction, PictureSize size, int stacked) const {
  if (fraction == 0.0 && size == cost_.size() && stacked == stacked_) return cost_;
  WorkGrid out(size);
  // Returns where the centre of a cell of the new picture is in the old one, in cells.
  const auto place = [](double px, int to, int from) { return px * from / to / kCutPx; };
  std::vector<Between> across;
  for (int x = 0; x < out.columns(); ++x) {
    const double middle = x * kCutPx + 0.5 * out.width_px(x) + fraction * size.width;
    across.push_back(between(place(middle, size.width, cost_.size().width), cost_.columns()));
  }
  const int rows = out.rows() / stacked;
  const int rows_before = cost_.rows() / stacked_;
  for (int y = 0; y < out.rows(); ++y) {
    const int picture = y / rows;
    const double middle = (y - picture * rows) * kCutPx + 0.5 * out.height_px(y);
    Between down = between(place(middle, size.height / stacked, cost_.size().height / stacked_), rows_before);
    const int above_it = std::min(picture, stacked_ - 1) * rows_before;
    down.first += above_it;
    down.second += above_it;
    for (int x = 0; x < out.columns(); ++x) {
      const Between& a = across[static_cast<std::size_t>(x)];
      const float above = (1.0f - a.t) * cost_.at(a.first, down.first) + a.t * cost_.at(a.second, down.first);
      const float below = (1.0f - a.t) * cost_.at(a.first, down.second) + a.t * cost_.at(a.second, down.second);
      out.at(x, y) = (1.0f - down.t) * above + down.t * below;
    }
  }
  return out;
}

WorkGrid CostMap::predict(const SplitRequest& request) {
  azimuth_span_rad_ = request.azimuth_span_rad == 0.0 ? 0.0 : usable(request.azimuth_span_rad, 1.0);
  WorkGrid cost(request.size, static_cast<float>(kFirstGuess));
  double effort = 1.0;
  const int stacked = usable_stack(request.size, request.stacked);
  if (is_known() && !cost.cells().empty()) {
    const Place at{request.heading_rad, request.eye_m};
    cost = moved(turn_seen(at, moves_eye(at) ? part_of_turn_ : 1.0), request.size, stacked);
    const bool moves = moves_eye(at) || at.heading_rad != place_.heading_rad;
    if (moves && options_.spreads > 0.0) cost = spread(cost, options_.spreads, stacked);
    effort = usable_effort(request.effort);
  }
  to_work(&cost, effort);
  return cost;
}

bool CostMap::moves_eye(const Place& at) const {
  double squared = 0.0;
  for (std::size_t i = 0; i < 3; ++i) squared += std::pow(at.eye_m[i] - place_.eye_m[i], 2);
  return !(squared <= kStill_m * kStill_m);
}

void CostMap::watch_motion(const WorkGrid& measured, const Place& at, int stacked) {
  if (!options_.turns || !moves_eye(at) || turn_seen(at, 1.0) == 0.0) return;
  // Candidate fractions of the turn, from slightly against it (content nearer than the centre of an orbit) to more than
  // the turn.
  constexpr double kParts[] = {-0.5, -0.25, 0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5};
  double best = part_of_turn_;
  double min = difference(moved(turn_seen(at, best), measured.size(), stacked), measured);
  for (const double part : kParts) {
    const double miss = difference(moved(turn_seen(at, part), measured.size(), stacked), measured);
    if (miss < min) {
      min = miss;
      best = part;
    }
  }
  part_of_turn_ += 0.5 * (best - part_of_turn_);
}

void CostMap::learn(const MeasuredFrame& frame) {
  if (frame.size.width <= 0 || frame.size.height <= 0) return;
  const Place at{std::isfinite(frame.heading_rad) ? frame.heading_rad : place_.heading_rad, frame.eye_m};
  const int stacked = usable_stack(frame.size, frame.stacked);
  WorkGrid expected(frame.size, static_cast<float>(kFirstGuess));
  if (is_known()) expected = moved(turn_seen(at, moves_eye(at) ? part_of_turn_ : 1.0), frame.size, stacked);
  WorkGrid prior = expected;
  to_work(&prior, 1.0);
  WorkGrid measured = work_of(frame.size, frame.blocks, options_.times, &prior);
  to_cost_per_px(&measured, usable_effort(frame.effort));
  double known = 0.0;
  std::size_t known_cells = 0;
  for (const float cost : measured.cells()) {
    if (!std::isfinite(cost)) continue;
    known += cost;
    ++known_cells;
  }
  if (!(known > 0.0)) return;  // Without measurements, or with zeros only, the map is kept.
  if (is_known()) {
    watch_motion(measured, at, stacked);
  } else {
    std::ranges::fill(expected.cells(), static_cast<float>(known / static_cast<double>(known_cells)));
  }
  const auto newest = static_cast<float>(is_known() ? options_.newest_weight : 1.0);
  for (std::size_t i = 0; i < measured.cells().size(); ++i) {
    float& cell = measured.cells()[i];
    const float before = expected.cells()[i];
    cell = std::isfinite(cell) ? newest * cell + (1.0f - newest) * before : before;
  }
  if (!mend(&measured)) return;
  cost_ = std::move(measured);
  stacked_ = stacked;
  place_ = at;
}

}  // namespace cyclorama::balance
