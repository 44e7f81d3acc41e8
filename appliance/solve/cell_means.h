// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "appliance/solve/measurements.h"

namespace cyclorama::solve {

/// Robust mean of one direction's correspondences within a cell, a small square of a projector's picture, referred to
/// the cell's centre.
struct CellMean {
  int direction = 0;
  int projector = 0;
  int cell = 0;                          ///< Index in the projector's lattice of cells, row by row.
  Eigen::Vector2d projector_px;          ///< The cell's centre.
  Eigen::Vector2d camera_px;             ///< Position of the cell's centre in the camera's picture.
  Eigen::Matrix2d camera_per_projector;  ///< Jacobian at the cell's centre.
  double sigma_px = 0.0;                 ///< Standard deviation of the mean in projector pixels, per axis.
};

struct CellMeans {
  int cell_px = 0;
  std::vector<CellMean> cells;  ///< Sorted by projector, then direction.
  std::size_t used = 0;         ///< Number of correspondences used.
  std::size_t refused = 0;      ///< Number that disagree with their neighbours, or have too few neighbours.
};

/// Averages correspondences over cells. This removes outliers (correspondences far from the prediction of their
/// neighbourhood), reduces noise, and turns millions of correspondences into thousands of means. Precondition:
/// measurements.validate(); cell_px >= 2. Reentrant.
[[nodiscard]] CellMeans average_cells(const Measurements& measurements, int cell_px);

/// Returns the smallest cell size of 8, 16, 32 or 64 pixels at which cells have enough correspondences.
[[nodiscard]] int fitting_cell_px(const Measurements& measurements);

}  // namespace cyclorama::solve
