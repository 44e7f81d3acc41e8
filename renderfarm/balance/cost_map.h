// SPDX-License-Identifier: Apache-2.0
/// Predicts the cost of each cell of the next picture from the nodes' recent measurements.
#pragma once

#include "renderfarm/balance/balancer.h"
#include "renderfarm/balance/work_grid.h"

namespace cyclorama::balance {

struct CostMapOptions {
  CellTimes times = CellTimes::kMeasured;
  /// Weight of a cell's newest measurement against its prediction, in (0, 1]. Less than 1 smooths noisy timers.
  double newest_weight = 1.0;
  /// True if costs shift with the picture's content.
  bool turns = true;
  /// Share of a cell's cost that is distributed over the cell and its eight neighbours when the view has moved, because
  /// expensive content may have moved there.
  double spreads = 0.2;
};

/// A map of costs, by cell, in seconds per pixel and unit of effort. When the eye only turns, the content of a panorama
/// shifts by the turn over the azimuth span. When the eye also moves, near content shifts differently; the map is then
/// shifted by the fraction of the turn that best explained the last frame (0 for an orbit around an object). Content
/// that enters at an edge is assumed to cost as much as the cells at the edge did. A picture that is not a panorama is
/// not shifted. In stereo, each eye's picture has separate costs. A value; thread-bound. Invariant: every cost is
/// finite and above zero.
class CostMap {
 public:
  explicit CostMap(const CostMapOptions& options = {}) : options_(options) {}

  /// Returns true once anything was learned. Before that, every pixel is assumed to cost one microsecond.
  [[nodiscard]] bool is_known() const { return !cost_.cells().empty(); }
  /// Returns the work of a picture's cells, in seconds at speed 1.
  [[nodiscard]] WorkGrid predict(const SplitRequest& request);
  void learn(const MeasuredFrame& frame);

 private:
  struct Place {
    double heading_rad = 0.0;
    std::array<double, 3> eye_m{};
  };
  [[nodiscard]] bool moves_eye(const Place& at) const;
  [[nodiscard]] double turn_seen(const Place& at, double part) const;
  /// Returns the costs per pixel, shifted by `fraction` of the width.
  [[nodiscard]] WorkGrid moved(double fraction, PictureSize size, int stacked) const;
  void watch_motion(const WorkGrid& measured, const Place& at, int stacked);

  CostMapOptions options_;
  WorkGrid cost_;                  ///< Costs per pixel at effort 1.
  int stacked_ = 1;                ///< Number of pictures in `cost_`, one above another.
  Place place_;                    ///< View to which the costs belong.
  double azimuth_span_rad_ = 1.0;  ///< 0 if turns shift nothing.
  double part_of_turn_ = 1.0;      ///< Fraction of the turn by which content shifts when the eye also moves.
};

}  // namespace cyclorama::balance
