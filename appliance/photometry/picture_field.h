// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <memory>
#include <span>
#include <vector>

namespace cyclorama::photometry {

/// A number for each place of a projector's picture that varies smoothly: a bicubic spline. A value; reentrant.
struct PictureField {
  int width_px = 0;
  int height_px = 0;
  int cells_x = 0;  ///< Between the spline's knots.
  int cells_y = 0;
  std::vector<double> coefficients{};  ///< (cells_x + 3) * (cells_y + 3), row by row.
  double min = 0.0;                    ///< What it says is kept within these: gaps are filled with slopes.
  double max = 0.0;

  /// PicturePositions outside count as the edge.
  [[nodiscard]] double at(const Eigen::Vector2d& pixel) const;
};

struct FieldSample {
  Eigen::Vector2d pixel;
  double sigma = 1.0;
};

/// Least squares with the energy of a thin plate. Movable.
class FieldFit {
 public:
  /// `bend` is the change of slope that is expected from a knot to the next.
  FieldFit(int width_px, int height_px, int knot_px, double bend, std::span<const FieldSample> samples);
  ~FieldFit();
  FieldFit(FieldFit&&) noexcept;
  FieldFit& operator=(FieldFit&&) noexcept;

  [[nodiscard]] bool is_solved() const;
  /// One value per sample. Linear in them.
  [[nodiscard]] PictureField fit(const Eigen::VectorXd& values) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace cyclorama::photometry
