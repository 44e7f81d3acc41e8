// SPDX-License-Identifier: Apache-2.0
/// Inter-reflection of a concave wall: radiosity on the wall's cells.
///
///     radiosity B = albedo * (E_direct + E_indirect),    E_indirect = F B,    F_ij = share of j in the view from i
///
/// so E_indirect = F albedo (1 - albedo F)^-1 E_direct, one matrix per colour, computed once. F is exact on a sphere;
/// elsewhere it is summed over pieces of the cells. It conserves energy: A_i F_ij = A_j F_ji, and no row sums to more
/// than 1. Source: Cohen and Wallace, "Radiosity and Realistic Image Synthesis", 1993, chapters 3 and 4.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "drivers/simulated/museum/wall_cells.h"

namespace cyclorama::simulated {

/// Reentrant.
class InterReflection {
 public:
  /// `albedo` must be below 1 in each colour. The cost is cubic in the number of cells: 0.1 s for 400.
  InterReflection(const TrueWall& wall, const WallCells& cells, const std::array<double, 3>& albedo);
  InterReflection(InterReflection&&) noexcept;
  InterReflection& operator=(InterReflection&&) noexcept;
  ~InterReflection();

  using Light = std::vector<std::array<double, 3>>;  ///< Per cell, lux.
  [[nodiscard]] Light indirect(const Light& direct) const;

  [[nodiscard]] const std::vector<double>& areas_m2() const { return areas_; }
  /// Form factor F_ij, the share of cell j in the view from cell i. For tests.
  [[nodiscard]] double form_factor(std::size_t i, std::size_t j) const;

 private:
  struct Matrices;
  std::vector<double> areas_;
  std::unique_ptr<const Matrices> matrices_;
};

}  // namespace cyclorama::simulated
