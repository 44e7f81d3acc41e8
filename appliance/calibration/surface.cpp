// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibration/surface.h"

#include <ceres/jet.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "appliance/calibration/direction_chart.h"
#include "common/base/check.h"

namespace cyclorama::calibration {
namespace {

constexpr std::string_view kNames[] = {"plane", "cylinder", "profile", "quadric", "mesh"};

/// The four nonzero weights at `x`, and their derivatives by x. Beyond the ends, the last span is extrapolated.
struct SplineWeights {
  int first = 0;
  std::array<double, 4> weights{};
  std::array<double, 4> slopes{};
};

SplineWeights spline_weights(const SplineAxis& axis, double x) {
  const double u = (x - axis.from) / axis.step;
  const int span = std::clamp(static_cast<int>(std::floor(std::clamp(u, -1.0, axis.spans + 1.0))), 0, axis.spans - 1);
  const double t = u - span;
  const double s = 1.0 - t;
  SplineWeights w;
  w.first = span;
  w.weights = {s * s * s / 6.0, (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
               (-3.0 * t * t * t + 3.0 * t * t + 3.0 * t + 1.0) / 6.0, t * t * t / 6.0};
  w.slopes = {-0.5 * s * s / axis.step, (1.5 * t * t - 2.0 * t) / axis.step, (-1.5 * t * t + t + 0.5) / axis.step,
              0.5 * t * t / axis.step};
  return w;
}

template <typename T>
using Vector3 = Eigen::Matrix<T, 3, 1>;

/// Returns R^T v, where R is a yaw about up, then a pitch about right, then a roll about back.
template <typename T>
Vector3<T> turned_back(const T& yaw, const T& pitch, const T& roll, const Eigen::Vector3d& v) {
  using std::cos;
  using std::sin;
  const T x1 = cos(yaw) * v.x() - sin(yaw) * v.z();
  const T z1 = sin(yaw) * v.x() + cos(yaw) * v.z();
  const T y2 = cos(pitch) * v.y() + sin(pitch) * z1;
  const T z2 = -sin(pitch) * v.y() + cos(pitch) * z1;
  return {cos(roll) * x1 + sin(roll) * y2, -sin(roll) * x1 + cos(roll) * y2, z2};
}

/// Intersects the line of sight with  a u² + b v² + c w² + d uv + e uw + f vw = w, in the frame of a wall that touches
/// this quadric at its origin; w points to the eye. Of the two intersections, returns the one that becomes the plane's
/// intersection when all coefficients vanish: the nearer one for a wall that bulges, the farther one for a wall that
/// surrounds the eye.
template <typename T>
bool quadric_inverse_depth(const Vector3<T>& eye, const Vector3<T>& d, const std::array<T, 6>& q,
                           T* ret_inverse_depth) {
  using std::sqrt;
  const T a = q[0] * d[0] * d[0] + q[1] * d[1] * d[1] + q[2] * d[2] * d[2] + q[3] * d[0] * d[1] + q[4] * d[0] * d[2] +
              q[5] * d[1] * d[2];
  const T b = -d[2] + 2.0 * (q[0] * eye[0] * d[0] + q[1] * eye[1] * d[1] + q[2] * eye[2] * d[2]) +
              q[3] * (eye[0] * d[1] + eye[1] * d[0]) + q[4] * (eye[0] * d[2] + eye[2] * d[0]) +
              q[5] * (eye[1] * d[2] + eye[2] * d[1]);
  const T c = -eye[2] + q[0] * eye[0] * eye[0] + q[1] * eye[1] * eye[1] + q[2] * eye[2] * eye[2] +
              q[3] * eye[0] * eye[1] + q[4] * eye[0] * eye[2] + q[5] * eye[1] * eye[2];
  const T within = b * b - 4.0 * a * c;
  if (!(within > 1e-12) || !(c < -1e-9)) return false;
  *ret_inverse_depth = -(b + sqrt(within)) / (2.0 * c);
  return true;
}

template <typename T>
bool closed_inverse_depth(SurfaceModel model, const Eigen::Vector3d& d, double distance, const T* p,
                          T* ret_inverse_depth) {
  const bool is_cylinder = model == SurfaceModel::kCylinder;
  const T roll = is_cylinder ? p[2] : T(0.0);
  const Vector3<T> observation = turned_back(p[0], p[1], roll, d);
  const Vector3<T> eye = turned_back(p[0], p[1], roll, Eigen::Vector3d(0.0, 0.0, distance));
  std::array<T, 6> q;
  q.fill(T(0.0));
  if (is_cylinder) q[0] = q[2] = 0.5 * p[3];
  if (model == SurfaceModel::kQuadric) {
    for (std::size_t i = 0; i < 6; ++i) q[i] = p[2 + i];
  }
  return quadric_inverse_depth(eye, observation, q, ret_inverse_depth);
}

template <int N>
std::optional<double> closed(SurfaceModel model, const Eigen::Vector3d& d, double distance, const double* parameters,
                             InverseDepthSlopes* ret_slopes) {
  if (ret_slopes == nullptr) {
    double inverse_depth = 0.0;
    if (!closed_inverse_depth(model, d, distance, parameters, &inverse_depth)) return std::nullopt;
    return inverse_depth;
  }
  using Jet = ceres::Jet<double, N>;
  std::array<Jet, static_cast<std::size_t>(N)> p;
  for (int i = 0; i < N; ++i) p[static_cast<std::size_t>(i)] = Jet(parameters[i], i);
  Jet inverse_depth;
  if (!closed_inverse_depth(model, d, distance, p.data(), &inverse_depth)) return std::nullopt;
  for (int i = 0; i < N; ++i) ret_slopes->add(i, inverse_depth.v[i]);
  return inverse_depth.a;
}

std::optional<double> profile(const SplineAxis& axis, const double* parameters, const Eigen::Vector3d& d,
                              InverseDepthSlopes* ret_slopes) {
  using Jet = ceres::Jet<double, 2>;
  const Vector3<Jet> observation = turned_back(Jet(0.0), Jet(parameters[0], 0), Jet(parameters[1], 1), d);
  const Jet flat = sqrt(observation[0] * observation[0] + observation[2] * observation[2]);
  if (!(flat.a > 1e-9)) return 0.0;  // Along the axis, the wall is infinitely far.
  const Jet angle = atan2(observation[0], -observation[2]);
  const SplineWeights w = spline_weights(axis, angle.a);
  double value = 0.0;
  double slope = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const double c = parameters[2 + w.first + static_cast<int>(i)];
    value += w.weights[i] * c;
    slope += w.slopes[i] * c;
  }
  if (ret_slopes != nullptr) {
    for (int i = 0; i < 2; ++i) ret_slopes->add(i, flat.v[i] * value + flat.a * slope * angle.v[i]);
    for (int i = 0; i < 4; ++i) {
      ret_slopes->add(2 + w.first + i, flat.a * w.weights[static_cast<std::size_t>(i)]);
    }
  }
  return flat.a * value;
}

/// Returns the angles of a direction from straight ahead, rightwards and upwards (azimuthal equidistant).
Eigen::Vector2d chart_position(const Eigen::Vector3d& d) {
  const double sine = std::hypot(d.x(), d.y());
  const double factor = sine < 1e-12 ? 1.0 : std::atan2(sine, -d.z()) / sine;
  return {factor * d.x(), factor * d.y()};
}

Eigen::Vector3d chart_direction(const Eigen::Vector2d& position) {
  const double angle = std::min(position.norm(), 3.1);
  const double factor = angle < 1e-9 ? 1.0 : std::sin(angle) / position.norm();
  return {factor * position.x(), factor * position.y(), -std::cos(angle)};
}

std::optional<double> mesh(const SplineAxis& across, const SplineAxis& up, const double* parameters,
                           const Eigen::Vector3d& d, InverseDepthSlopes* ret_slopes) {
  const Eigen::Vector2d position = chart_position(d);
  const SplineWeights wx = spline_weights(across, position.x());
  const SplineWeights wy = spline_weights(up, position.y());
  const int columns = across.coefficients();
  double value = 0.0;
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 4; ++i) {
      const int at = (wy.first + j) * columns + wx.first + i;
      const double weight = wx.weights[static_cast<std::size_t>(i)] * wy.weights[static_cast<std::size_t>(j)];
      value += weight * parameters[at];
      if (ret_slopes != nullptr) ret_slopes->add(at, weight);
    }
  }
  return value;
}

SplineAxis axis_over(double from, double to, double step) {
  const int spans = std::clamp(static_cast<int>(std::ceil((to - from) / step)), 1, 64);
  const double length = std::max((to - from) * 1.0001, 1e-4);
  return {from, length / spans, spans};
}

}  // namespace

std::string_view name_of(SurfaceModel model) { return kNames[static_cast<std::size_t>(model)]; }

std::optional<SurfaceModel> surface_model(std::string_view name) {
  for (const SurfaceModel model : kSurfaceModels) {
    if (name_of(model) == name) return model;
  }
  return std::nullopt;
}

int Surface::size() const {
  switch (model) {
    case SurfaceModel::kPlane:
      return 2;
    case SurfaceModel::kCylinder:
      return 4;
    case SurfaceModel::kProfile:
      return 2 + across.coefficients();
    case SurfaceModel::kQuadric:
      return 8;
    case SurfaceModel::kMesh:
      return across.coefficients() * up.coefficients();
  }
  return 0;
}

std::optional<double> Surface::inverse_depth_at(const double* p, const Eigen::Vector3d& direction,
                                                InverseDepthSlopes* ret_slopes) const {
  if (ret_slopes != nullptr) ret_slopes->count = 0;
  const Eigen::Vector3d d = R_eye_wall.transpose() * direction;
  std::optional<double> inverse_depth;
  switch (model) {
    case SurfaceModel::kPlane:
      inverse_depth = closed<2>(model, d, distance_m, p, ret_slopes);
      break;
    case SurfaceModel::kCylinder:
      inverse_depth = closed<4>(model, d, distance_m, p, ret_slopes);
      break;
    case SurfaceModel::kQuadric:
      inverse_depth = closed<8>(model, d, distance_m, p, ret_slopes);
      break;
    case SurfaceModel::kProfile:
      inverse_depth = profile(across, p, d, ret_slopes);
      break;
    case SurfaceModel::kMesh:
      inverse_depth = mesh(across, up, p, d, ret_slopes);
      break;
  }
  if (!inverse_depth || !std::isfinite(*inverse_depth)) return std::nullopt;
  return inverse_depth;
}

double Surface::curvature_per_m() const {
  CHECK(model == SurfaceModel::kPlane || model == SurfaceModel::kCylinder);
  return model == SurfaceModel::kCylinder ? parameters[3] : 0.0;
}

Surface Surface::start(SurfaceModel model, const Surface& from, const std::vector<Eigen::Vector3d>& spread,
                       double knot_rad) {
  Surface surface = from;
  surface.model = model;
  const auto inverse_depth = [&](const Eigen::Vector3d& d_wall) {
    return std::clamp(from.inverse_depth_at(from.R_eye_wall * d_wall).value_or(0.5 / from.distance_m),
                      0.05 / from.distance_m, 4.0 / from.distance_m);
  };
  if (model == SurfaceModel::kPlane) surface.parameters = {0.0, 0.0};
  if (model == SurfaceModel::kCylinder) {
    const bool is_plane = from.model == SurfaceModel::kPlane;
    surface.parameters = {is_plane ? from.parameters[0] : 0.0, is_plane ? from.parameters[1] : 0.0, 0.0, 0.0};
  }
  if (model == SurfaceModel::kQuadric) {
    surface.parameters.assign(8, 0.0);
    if (from.model == SurfaceModel::kPlane || from.model == SurfaceModel::kCylinder) {
      surface.parameters[0] = from.parameters[0];
      surface.parameters[1] = from.parameters[1];
      const double k = 0.5 * from.curvature_per_m();
      const double roll = from.model == SurfaceModel::kCylinder ? from.parameters[2] : 0.0;
      // The direction in which the cylinder bends, (cos, sin) of its roll, expressed in unrolled axes.
      surface.parameters[2] = k * std::cos(roll) * std::cos(roll);
      surface.parameters[3] = k * std::sin(roll) * std::sin(roll);
      surface.parameters[4] = k;
      surface.parameters[5] = 2.0 * k * std::cos(roll) * std::sin(roll);
    }
  }
  if (model != SurfaceModel::kProfile && model != SurfaceModel::kMesh) return surface;
  Eigen::Vector2d min(1e9, 1e9);
  Eigen::Vector2d max(-1e9, -1e9);
  for (const Eigen::Vector3d& direction : spread) {
    const Eigen::Vector3d d = from.R_eye_wall.transpose() * direction;
    const Eigen::Vector2d position =
        model == SurfaceModel::kMesh ? chart_position(d) : Eigen::Vector2d(std::atan2(d.x(), -d.z()), 0.0);
    min = min.cwiseMin(position);
    max = max.cwiseMax(position);
  }
  CHECK(!spread.empty());
  surface.across = axis_over(min.x(), max.x(), knot_rad);
  surface.up = model == SurfaceModel::kMesh ? axis_over(min.y(), max.y(), knot_rad) : SplineAxis{};
  surface.parameters.clear();
  const auto knot = [](const SplineAxis& axis, int i) { return axis.from + (i - 1) * axis.step; };
  if (model == SurfaceModel::kProfile) {
    surface.parameters = {0.0, 0.0};
    for (int i = 0; i < surface.across.coefficients(); ++i) {
      const double angle = knot(surface.across, i);
      surface.parameters.push_back(inverse_depth({std::sin(angle), 0.0, -std::cos(angle)}));
    }
    return surface;
  }
  for (int j = 0; j < surface.up.coefficients(); ++j) {
    for (int i = 0; i < surface.across.coefficients(); ++i) {
      surface.parameters.push_back(inverse_depth(chart_direction({knot(surface.across, i), knot(surface.up, j)})));
    }
  }
  return surface;
}

}  // namespace cyclorama::calibration
