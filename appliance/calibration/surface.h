// SPDX-License-Identifier: Apache-2.0
/// The wall as the sweet spot sees it: for each direction how near it is. A selection of models, each with more to tell:
///
///     plane       2   its normal
///     cylinder    4   and its axis' roll and its curvature: 0 is a plane, so nothing jumps between the two
///     profile     2+n the axis' tilt, and the distance along the arc: corners, and cylinders that are not quite ones
///     quadric     8   spheres, ellipsoids and their kin
///     mesh        n   inverse_depth over a grid of directions
///
/// Their common scale is not theirs to tell: the wall is `distance_m` away straight ahead. Reentrant.
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
/// Nothing for any other text.
[[nodiscard]] std::optional<SurfaceModel> surface_model(std::string_view name);

/// Where the knots of a spline lie: even, cubic. `spans` + 3 coefficients.
struct SplineAxis {
  double from = 0.0;
  double step = 1.0;
  int spans = 1;
  [[nodiscard]] int coefficients() const { return spans + 3; }
};

/// What a inverse_depth changes by: a spline's knows only the coefficients nearby.
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

/// A value.
struct Surface {
  SurfaceModel model = SurfaceModel::kPlane;
  /// Columns: right, up, back, of an eye that looks at the wall's middle. Right-handed.
  Eigen::Matrix3d R_eye_wall = Eigen::Matrix3d::Identity();
  double distance_m = 4.0;
  SplineAxis across{};  ///< Of a profile (angle about the axis) and of a mesh (angles of its chart).
  SplineAxis up{};      ///< Of a mesh.
  std::vector<double> parameters;

  /// How many parameters this model has.
  [[nodiscard]] int size() const;
  /// The inverse of the distance in metres along a unit vector, 0 where the wall is endlessly far; `ret_slopes` (may be
  /// null) gets its derivatives by the parameters. Nothing where the line of sight misses the wall.
  [[nodiscard]] std::optional<double> inverse_depth_at(const double* parameters, const Eigen::Vector3d& direction,
                                                       InverseDepthSlopes* ret_slopes) const;
  [[nodiscard]] std::optional<double> inverse_depth_at(const Eigen::Vector3d& direction) const {
    return inverse_depth_at(parameters.data(), direction, nullptr);
  }
  /// Of a plane 0; of a cylinder its own; in 1/m, positive where the wall bends round the eye. Precondition: one of
  /// them.
  [[nodiscard]] double curvature_per_m() const;

  /// A start for a model: what `from` is, if it can be told in the richer model's words, else a plane. `spread` are
  /// directions that the spline must reach.
  static Surface start(SurfaceModel model, const Surface& from, const std::vector<Eigen::Vector3d>& spread,
                       double knot_rad);
};

}  // namespace cyclorama::calibration
