// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "appliance/solve/cell_means.h"
#include "common/base/result.h"

namespace cyclorama::solve {

/// One cell of a projector that several directions see (a track in bundle adjustment).
struct Track {
  std::vector<std::size_t> cells;  ///< Indices into CellMeans::cells.
};

struct ChosenTracks {
  std::vector<Track> used;
  std::vector<Track> left_out;
};

inline constexpr std::size_t kMinTracks = 12;

/// Chooses tracks that are spread over the overlaps of directions, equally many for each pair of directions, and leaves
/// some of them out for testing. Errors: kInvalidArgument, with the remedy, if the directions are not all connected by
/// overlaps or there is only one. Reentrant.
Result<ChosenTracks> choose_tracks(const Measurements& measurements, const CellMeans& means, std::size_t max,
                                   std::size_t left_out_every);

}  // namespace cyclorama::solve
