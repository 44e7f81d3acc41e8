// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "appliance/solve/cell_means.h"
#include "common/base/result.h"

namespace cyclorama::solve {

/// One cell of a projector as several directions see it.
struct Track {
  std::vector<std::size_t> cells;  ///< Into CellMeans::cells.
};

struct ChosenTracks {
  std::vector<Track> used;
  std::vector<Track> left_out;
};

inline constexpr std::size_t kMinTracks = 12;

/// Tracks spread over what directions share, of each pair of them alike, some left out to be predicted.
/// kInvalidArgument  directions do not hang together by overlaps, or there is but one: says which, and what to add.
/// Reentrant.
Result<ChosenTracks> choose_tracks(const Measurements& measurements, const CellMeans& means, std::size_t max,
                                   std::size_t left_out_every);

}  // namespace cyclorama::solve
