// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/balance/cost_map.h"

#include <algorithm>
#include <cmath>

#include "renderfarm/balance/tiles.h"

namespace cyclorama {
namespace {

/// Seconds per pixel before anything is measured: a sample or two on one core.
constexpr double kFirstGuess = 1e-6;
/// Of the mean cost per pixel: a cell that cost nothing must not swallow the picture in the next frame.
constexpr double kLeast = 0.01;
constexpr double kStill_m = 1e-4;

double usable(double value, double otherwise) { return std::isfinite(value) && value > 0.0 ? value : otherwise; }

float cost_per_px(const WorkGrid& work, int x, int y) {
  return work.at(x, y) / static_cast<float>(work.width_px(x) * work.height_px(y));
}

/// Between the middles of cells, linearly: where in cells a place lies, given in cells from the edge.
struct Between {
  int first = 0;
  int second = 0;
  float t = 0.0f;  ///< Of the second.
};
Between between(double place, int cells) {
  const double from = std::clamp(place - 0.5, 0.0, cells - 1.0);
  const int first = static_cast<int>(from);
  return {first, std::min(first + 1, cells - 1), static_cast<float>(from - first)};
}

/// No cell below kLeast of the mean, nothing that is no number; false if there is no work at all.
bool mend(WorkGrid* work) {
  const PictureSize size = work->size();
  const double mean = work->total() / (double(size.width) * size.height);
  if (!(mean > 0.0 && std::isfinite(mean))) return false;
  for (int y = 0; y < work->rows(); ++y) {
    for (int x = 0; x < work->columns(); ++x) {
      const double least = kLeast * mean * work->width_px(x) * work->height_px(y);
      float& cell = work->at(x, y);
      cell = std::max(cell, static_cast<float>(least));
    }
  }
  return true;
}

/// Each cell gives a ninth of `part` of its cost per pixel to itself and to each of its neighbours.
WorkGrid spread(const WorkGrid& work, double part) {
  WorkGrid density(work.size());
  for (int y = 0; y < work.rows(); ++y) {
    for (int x = 0; x < work.columns(); ++x) density.at(x, y) = cost_per_px(work, x, y);
  }
  WorkGrid rows(work.size());  // Sums of three, along.
  const int last_x = work.columns() - 1;
  const int last_y = work.rows() - 1;
  for (int y = 0; y <= last_y; ++y) {
    for (int x = 0; x <= last_x; ++x) {
      rows.at(x, y) = density.at(std::max(x - 1, 0), y) + density.at(x, y) + density.at(std::min(x + 1, last_x), y);
    }
  }
  WorkGrid out(work.size());
  const auto own = static_cast<float>(1.0 - part);
  const auto ninth = static_cast<float>(part / 9.0);
  for (int y = 0; y <= last_y; ++y) {
    for (int x = 0; x <= last_x; ++x) {
      const float around = rows.at(x, std::max(y - 1, 0)) + rows.at(x, y) + rows.at(x, std::min(y + 1, last_y));
      out.at(x, y) =
          (own * density.at(x, y) + ninth * around) * static_cast<float>(work.width_px(x) * work.height_px(y));
    }
  }
  return out;
}

double difference(const WorkGrid& a, const WorkGrid& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.cells().size(); ++i) {
    // A cell that was not measured says nothing.
    if (std::isfinite(b.cells()[i])) sum += std::abs(a.cells()[i] - b.cells()[i]);
  }
  return sum;
}

}  // namespace

double CostMap::turn_seen(const Place& at, double part) const {
  const double turn = options_.turns ? part * (at.heading_rad - place_.heading_rad) / azimuth_span_rad_ : 0.0;
  return std::isfinite(turn) ? std::clamp(turn, -1.0, 1.0) : 0.0;
}

WorkGrid CostMap::moved(double fraction, PictureSize size) const {
  if (fraction == 0.0 && size == work_.size()) return work_;
  WorkGrid out(size);
  // Where the middle of a cell of the new picture was in the old one, in cells.
  const auto place = [](double px, int to, int from) { return px * from / to / kCutPx; };
  std::vector<Between> across;
  for (int x = 0; x < out.columns(); ++x) {
    const double middle = x * kCutPx + 0.5 * out.width_px(x) + fraction * size.width;
    across.push_back(between(place(middle, size.width, work_.size().width), work_.columns()));
  }
  for (int y = 0; y < out.rows(); ++y) {
    const Between down =
        between(place(y * kCutPx + 0.5 * out.height_px(y), size.height, work_.size().height), work_.rows());
    for (int x = 0; x < out.columns(); ++x) {
      const Between& a = across[static_cast<std::size_t>(x)];
      const float above =
          (1.0f - a.t) * cost_per_px(work_, a.first, down.first) + a.t * cost_per_px(work_, a.second, down.first);
      const float below =
          (1.0f - a.t) * cost_per_px(work_, a.first, down.second) + a.t * cost_per_px(work_, a.second, down.second);
      out.at(x, y) =
          ((1.0f - down.t) * above + down.t * below) * static_cast<float>(out.width_px(x) * out.height_px(y));
    }
  }
  return out;
}

WorkGrid CostMap::predict(const SplitRequest& request) {
  azimuth_span_rad_ = usable(request.azimuth_span_rad, 1.0);
  WorkGrid work(request.size);
  if (!is_known()) {
    for (int y = 0; y < work.rows(); ++y) {
      for (int x = 0; x < work.columns(); ++x) {
        work.at(x, y) = static_cast<float>(kFirstGuess * work.width_px(x) * work.height_px(y));
      }
    }
    return work;
  }
  if (work.cells().empty()) return work;
  const Place at{request.heading_rad, request.eye_m};
  work = moved(turn_seen(at, moves_eye(at) ? part_of_turn_ : 1.0), request.size);
  const bool moves = moves_eye(at) || at.heading_rad != place_.heading_rad;
  if (moves && options_.spreads > 0.0) work = spread(work, options_.spreads);
  const auto effort = static_cast<float>(std::clamp(usable(request.effort, 1.0), 1e-9, 1e9));
  for (float& cell : work.cells()) cell *= effort;
  return work;
}

bool CostMap::moves_eye(const Place& at) const {
  double squared = 0.0;
  for (std::size_t i = 0; i < 3; ++i) squared += std::pow(at.eye_m[i] - place_.eye_m[i], 2);
  return !(squared <= kStill_m * kStill_m);
}

void CostMap::watch_motion(const WorkGrid& measured, const Place& at) {
  if (!options_.turns || !moves_eye(at) || turn_seen(at, 1.0) == 0.0) return;
  // A few parts of the turn, from a little against it (what is nearer than the point that an orbit looks at) to more
  // than it.
  constexpr double kParts[] = {-0.5, -0.25, 0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5};
  double best = part_of_turn_;
  double least = difference(moved(turn_seen(at, best), measured.size()), measured);
  for (const double part : kParts) {
    const double miss = difference(moved(turn_seen(at, part), measured.size()), measured);
    if (miss < least) {
      least = miss;
      best = part;
    }
  }
  part_of_turn_ += 0.5 * (best - part_of_turn_);
}

void CostMap::learn(const MeasuredFrame& frame) {
  if (frame.size.width <= 0 || frame.size.height <= 0) return;
  const Place at{std::isfinite(frame.heading_rad) ? frame.heading_rad : place_.heading_rad, frame.eye_m};
  WorkGrid expected;
  if (is_known()) expected = moved(turn_seen(at, moves_eye(at) ? part_of_turn_ : 1.0), frame.size);
  WorkGrid measured = work_of(frame.size, frame.blocks, options_.times, is_known() ? &expected : nullptr);
  const auto effort = static_cast<float>(std::clamp(usable(frame.effort, 1.0), 1e-9, 1e9));
  for (float& cell : measured.cells()) cell /= effort;
  double known = 0.0;
  double known_px = 0.0;
  for (int y = 0; y < measured.rows(); ++y) {
    for (int x = 0; x < measured.columns(); ++x) {
      if (!std::isfinite(measured.at(x, y))) continue;
      known += measured.at(x, y);
      known_px += measured.width_px(x) * measured.height_px(y);
    }
  }
  if (!(known > 0.0)) return;  // Nothing measured, or nothing but zeroes: no reason to change.
  if (is_known()) watch_motion(measured, at);
  const auto newest = static_cast<float>(options_.newest_weight);
  for (int y = 0; y < measured.rows(); ++y) {
    for (int x = 0; x < measured.columns(); ++x) {
      float& cell = measured.at(x, y);
      if (is_known()) {
        cell = std::isfinite(cell) ? newest * cell + (1.0f - newest) * expected.at(x, y) : expected.at(x, y);
      } else if (!std::isfinite(cell)) {
        cell = static_cast<float>(known / known_px * measured.width_px(x) * measured.height_px(y));
      }
    }
  }
  if (!mend(&measured)) return;
  work_ = std::move(measured);
  place_ = at;
}

}  // namespace cyclorama
