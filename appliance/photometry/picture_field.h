// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <memory>
#include <span>
#include <vector>

namespace cyclorama::photometry {

/// A smooth scalar field over a projector's picture: a bicubic spline. A value; reentrant.
struct PictureField {
  int width_px = 0;
  int height_px = 0;
  int cells_x = 0;  ///< Number of intervals between the spline's knots.
  int cells_y = 0;
  std::vector<double> coefficients{};  ///< (cells_x + 3) * (cells_y + 3), row by row.
  /// The field's values are clamped to [min, max], because gaps are extrapolated with slopes.
  double min = 0.0;
  double max = 0.0;

  /// Positions outside the picture are clamped to its edge.
  [[nodiscard]] double at(const Eigen::Vector2d& pixel) const;
};

struct FieldSample {
  Eigen::Vector2d pixel;
  double sigma = 1.0;
};

/// Least-squares fit with thin-plate smoothness. Movable.
class FieldFit {
 public:
  /// `bend` is the expected change of slope from one knot to the next.
  FieldFit(int width_px, int height_px, int knot_px, double bend, std::span<const FieldSample> samples);
  ~FieldFit();
  FieldFit(FieldFit&&) noexcept;
  FieldFit& operator=(FieldFit&&) noexcept;

  [[nodiscard]] bool is_solved() const;
  /// `values` has one value per sample. The fit is linear in the values.
  [[nodiscard]] PictureField fit(const Eigen::VectorXd& values) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace cyclorama::photometry
