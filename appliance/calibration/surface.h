// SPDX-License-Identifier: Apache-2.0
/// The wall as seen from the sweet spot: its inverse depth in each direction. The candidate models, from the smallest
/// to the richest:
///
///     plane       2   the normal
///     cylinder    4   also the roll of its axis and its curvature; curvature 0 is a plane, so the transition is smooth
///     profile     2+n tilt of the axis, and the distance along the arc: corners, and approximate cylinders
///     quadric     8   spheres, ellipsoids and similar surfaces
///     mesh        n   inverse depth over a grid of directions
///
/// The overall scale is not a parameter: the wall is `distance_m` away straight ahead. Reentrant.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string_view>
#include <vector>

namespace cyclorama::calibration {

enum class SurfaceModel { kPlane, kCylinder, kProfile, kQuadric, kMesh };
inline constexpr SurfaceModel kSurfaceModels[] = {SurfaceModel::kPlane, SurfaceModel::kCylinder, SurfaceModel::kProfile,
                                                  SurfaceModel::kQuadric, SurfaceModel::kMesh};
[[nodiscard]] std::string_view name_of(SurfaceModel model);
/// Returns the model of that name; empty for any other text.
[[nodiscard]] std::optional<SurfaceModel> surface_model(std::string_view name);

/// Uniform knots of a cubic spline with `spans` + 3 coefficients.
struct SplineAxis {
  double from = 0.0;
  double step = 1.0;
  int spans = 1;
  [[nodiscard]] int coefficients() const { return spans + 3; }
};

/// Derivatives of an inverse depth by the parameters; those of a spline are nonzero only for nearby coefficients.
struct InverseDepthSlopes {
  static constexpr int kMaxParameters = 16;
  int count = 0;
  std::array<int, kMaxParameters> parameters{};
  std::array<double, kMaxParameters> slopes{};
  void add(int parameter, double slope) {
    parameters[static_cast<std::size_t>(count)] = parameter;
    slopes[static_cast<std::size_t>(count++)] = slope;
  }
};

struct Surface {
  SurfaceModel model = SurfaceModel::kPlane;
  /// Columns: right, up and back of an eye that looks at the wall's middle. Right-handed.
  Eigen::Matrix3d R_eye_wall = Eigen::Matrix3d::Identity();
  double distance_m = 4.0;
  SplineAxis across{};  ///< Knots of a profile (angle about the axis) and of a mesh (first angle of its chart).
  SplineAxis up{};      ///< Knots of a mesh (second angle).
  std::vector<double> parameters;

  /// Returns the number of the model's parameters.
  [[nodiscard]] int size() const;
  /// Returns the inverse of the distance in metres along a unit vector; 0 where the wall is infinitely far.
  /// `ret_slopes` (may be null) receives its derivatives by the parameters. Empty if the line of sight misses the wall.
  [[nodiscard]] std::optional<double> inverse_depth_at(const double* parameters, const Eigen::Vector3d& direction,
                                                       InverseDepthSlopes* ret_slopes) const;
  [[nodiscard]] std::optional<double> inverse_depth_at(const Eigen::Vector3d& direction) const {
    return inverse_depth_at(parameters.data(), direction, nullptr);
  }
  /// Returns the curvature in 1/m: 0 for a plane; positive for a cylinder that bends around the eye. Precondition: the
  /// model is a plane or a cylinder.
  [[nodiscard]] double curvature_per_m() const;

  /// Returns an initial estimate for a model: `from` if the model can represent it, else a plane. `spread` lists
  /// directions that a spline must cover, with a knot every `knot_rad`.
  static Surface start(SurfaceModel model, const Surface& from, const std::vector<Eigen::Vector3d>& spread,
                       double knot_rad);
};

}  // namespace cyclorama::calibration
