// SPDX-License-Identifier: Apache-2.0
#include "appliance/solve/tracks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

namespace cyclorama::solve {
namespace {

double degrees(double rad) { return rad * 180.0 / std::numbers::pi; }

/// Union-find over directions: connected directions have the same group number.
class Groups {
 public:
  explicit Groups(std::size_t count) : of_(count) { std::iota(of_.begin(), of_.end(), std::size_t{0}); }
  void join(std::size_t a, std::size_t b) {
    const std::size_t from = of_[a];
    const std::size_t to = of_[b];
    for (std::size_t& group : of_) {
      if (group == from) group = to;
    }
  }
  [[nodiscard]] std::size_t of(std::size_t i) const { return of_[i]; }

 private:
  std::vector<std::size_t> of_;
};

}  // namespace

Result<ChosenTracks> choose_tracks(const Measurements& measurements, const CellMeans& means, std::size_t max,
                                   std::size_t left_out_every) {
  const std::size_t count = measurements.directions.size();
  std::map<std::pair<int, int>, Track> by_position;  // (projector, cell)
  std::vector<std::size_t> seen(count, 0);
  for (std::size_t i = 0; i < means.cells.size(); ++i) {
    const CellMean& cell = means.cells[i];
    by_position[{cell.projector, cell.cell}].cells.push_back(i);
    ++seen[static_cast<std::size_t>(cell.direction)];
  }
  if (count < 2) {
    return Error(ErrorCode::kInvalidArgument,
                 "one direction alone does not determine the turntable's axis; add a direction that overlaps it by at "
                 "least a tenth");
  }
  // Tracks indexed by the first and last direction that see them.
  std::map<std::pair<int, int>, std::vector<const Track*>> by_pair;
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> shared;
  for (const auto& [position, track] : by_position) {
    if (track.cells.size() < 2) continue;
    by_pair[{means.cells[track.cells.front()].direction, means.cells[track.cells.back()].direction}].push_back(&track);
    for (std::size_t a = 0; a < track.cells.size(); ++a) {
      for (std::size_t b = a + 1; b < track.cells.size(); ++b) {
        ++shared[{static_cast<std::size_t>(means.cells[track.cells[a]].direction),
                  static_cast<std::size_t>(means.cells[track.cells[b]].direction)}];
      }
    }
  }
  Groups groups(count);
  for (const auto& [pair, tracks] : shared) {
    if (tracks >= kMinTracks) groups.join(pair.first, pair.second);
  }
  std::size_t first = count;
  for (std::size_t d = 0; d < count; ++d) {
    if (seen[d] == 0) continue;  // A direction that sees no projector is allowed.
    if (first == count) first = d;
    if (groups.of(d) == groups.of(first)) continue;
    const double a = degrees(measurements.directions[first].angle_rad);
    const double b = degrees(measurements.directions[d].angle_rad);
    return Error(
        ErrorCode::kInvalidArgument,
        fmt::format("the directions at {:.1f} and {:.1f} degrees share {} places of any projector and need {}, "
                    "also by way of others; add a direction at about {:.1f} degrees",
                    a, b, shared[{first, d}], kMinTracks, 0.5 * (a + b)));
  }
  if (by_pair.empty()) {
    return Error(ErrorCode::kInvalidArgument,
                 "no two directions see the same place of a projector; add directions that overlap, and look whether "
                 "the projectors shine and decoding found their pixels");
  }
  ChosenTracks chosen;
  std::size_t total = 0;
  const std::size_t each = std::max<std::size_t>(2 * kMinTracks, max / by_pair.size());
  for (const auto& [pair, tracks] : by_pair) {
    const std::size_t step = std::max<std::size_t>(1, tracks.size() / each);
    for (std::size_t i = step / 2; i < tracks.size(); i += step) {
      (++total % left_out_every == 0 ? chosen.left_out : chosen.used).push_back(*tracks[i]);
    }
  }
  if (chosen.used.size() < kMinTracks) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("only {} places are seen from several directions, {} are needed; add directions that "
                             "overlap more",
                             chosen.used.size(), kMinTracks));
  }
  return chosen;
}

}  // namespace cyclorama::solve
