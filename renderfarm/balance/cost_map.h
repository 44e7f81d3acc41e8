// SPDX-License-Identifier: Apache-2.0
/// What each cell of the next picture is expected to cost, from what the nodes measured in the last ones.
#pragma once

#include "renderfarm/balance/balancer.h"
#include "renderfarm/balance/work_grid.h"

namespace cyclorama {

struct CostMapOptions {
  CellTimes times = CellTimes::kMeasured;
  /// How much of a cell is its newest measurement, (0, 1]; the rest is what was expected of it. Timers are noisy.
  double newest_weight = 1.0;
  /// Whether the costs move with the picture's content.
  bool turns = true;
  /// Part of a cell's cost that it shares with its eight neighbours when the view has moved: what is expensive may have
  /// gone there.
  double spreads = 0.2;
};

/// Seconds per pixel and effort, in cells. When the eye only turns, the content of a panorama moves by the turn over
/// the azimuth span. When the eye also walks, near content moves otherwise; then it moves by as much of the turn as
/// explained the last frame best (an orbit around a relic: by nothing at all). What comes in at an edge costs as the
/// edge did. A picture that is no panorama stays where it is. Of two eyes' pictures each has its own costs. A value;
/// thread-bound. Invariant: every cost is finite and above zero.
class CostMap {
 public:
  explicit CostMap(const CostMapOptions& options = {}) : options_(options) {}

  /// Whether anything was learned; until then every pixel is taken to cost a microsecond.
  [[nodiscard]] bool is_known() const { return !cost_.cells().empty(); }
  /// Work of a picture's cells, in seconds at speed 1.
  [[nodiscard]] WorkGrid predict(const SplitRequest& request);
  void learn(const MeasuredFrame& frame);

 private:
  struct Place {
    double heading_rad = 0.0;
    std::array<double, 3> eye_m{};
  };
  [[nodiscard]] bool moves_eye(const Place& at) const;
  [[nodiscard]] double turn_seen(const Place& at, double part) const;
  /// Per pixel.
  [[nodiscard]] WorkGrid moved(double fraction, PictureSize size, int stacked) const;
  void watch_motion(const WorkGrid& measured, const Place& at, int stacked);

  CostMapOptions options_;
  WorkGrid cost_;                  ///< Per pixel, of effort 1.
  int stacked_ = 1;                ///< Pictures in it, one above another.
  Place place_;                    ///< Whose costs they are.
  double azimuth_span_rad_ = 1.0;  ///< 0: nothing moves.
  double part_of_turn_ = 1.0;      ///< That the content moves by when the eye walks too.
};

}  // namespace cyclorama
