// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "appliance/solve/measurements.h"

namespace cyclorama::solve {

/// What one direction's picture says of a small square of a projector's picture: a robust mean of what was decoded in
/// it, brought to the square's centre.
struct CellMean {
  int direction = 0;
  int projector = 0;
  int cell = 0;                          ///< Row by row, in the projector's lattice; the same in every direction.
  Eigen::Vector2d projector_px;          ///< The cell's centre.
  Eigen::Vector2d camera_px;             ///< Where the camera sees it.
  Eigen::Matrix2d camera_per_projector;  ///< Slope there.
  double sigma_px = 0.0;                 ///< Of the mean, in projector pixels, each way.
};

struct CellMeans {
  int cell_px = 0;
  std::vector<CellMean> cells;  ///< By projector, then direction.
  std::size_t used = 0;         ///< Correspondences.
  std::size_t refused = 0;      ///< Those that disagree with their neighbours, or have too few of them.
};

/// Gross errors go (a correspondence that is far from what its neighbourhood says), noise becomes small, and millions
/// become thousands. Precondition: measurements.validate(); cell_px of 2 and more. Reentrant.
[[nodiscard]] CellMeans average_cells(const Measurements& measurements, int cell_px);

/// The least cell of 8, 16, 32 or 64 pixels that holds enough: decoders differ in how many they deliver.
[[nodiscard]] int fitting_cell_px(const Measurements& measurements);

}  // namespace cyclorama::solve
