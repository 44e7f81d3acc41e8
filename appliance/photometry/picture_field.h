// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <memory>
#include <span>
#include <vector>

namespace cyclorama::photometry {

/// Smooth scalar field over a projector's picture: a bicubic spline. A value; reentrant.
struct PictureField {
  int width_px = 0;
  int height_px = 0;
  int cells_x = 0;  ///< Number of intervals between the spline's knots.
  int cells_y = 0;
  std::vector<double> coefficients{};  ///< (cells_x + 3) * (cells_y + 3), row by row.
  /// Values are clamped to [min, max], because gaps are extrapolated linearly.
  double min = 0.0;
  double max = 0.0;

  /// Returns the value at a position, which is clamped to the picture.
  [[nodiscard]] double at(const Eigen::Vector2d& pixel) const;
};

struct FieldSample {
  Eigen::Vector2d pixel;
  double sigma = 1.0;
};

/// Least-squares fit of a field with thin-plate smoothness. Movable.
class FieldFit {
 public:
  /// Prepares a fit to values at `samples`. `bend` is the expected change of slope from one knot to the next.
  FieldFit(int width_px, int height_px, int knot_px, double bend, std::span<const FieldSample> samples);
  ~FieldFit();
  FieldFit(FieldFit&&) noexcept;
  FieldFit& operator=(FieldFit&&) noexcept;

  [[nodiscard]] bool is_solved() const;
  /// Returns the field for one value per sample. The coefficients are linear in the values.
  [[nodiscard]] PictureField fit(const Eigen::VectorXd& values) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace cyclorama::photometry
