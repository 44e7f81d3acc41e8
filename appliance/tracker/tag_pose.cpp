// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/tag_pose.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/check.h"

namespace cyclorama::tracker {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Corners2 = std::array<Vector2d, 4>;
using Corners3 = std::array<Vector3d, 4>;

/// Doubled area below which a quadrilateral is practically a line or a point.
constexpr double kMinDoubledAreaPx2 = 2.0;
/// Angle between two minima below which they count as one.
constexpr double kSamePoseRad = 1e-3;

bool is_usable(const Corners2& corners) {
  for (std::size_t i = 0; i < 4; ++i) {
    if (!corners[i].allFinite()) return false;
    const Vector2d a = corners[(i + 1) % 4] - corners[i];
    const Vector2d b = corners[(i + 2) % 4] - corners[(i + 1) % 4];
    if (!(a.x() * b.y() - a.y() * b.x() > 0.0)) return false;  // Not convex, or seen from behind.
  }
  return tags::doubled_area_px2(corners) > kMinDoubledAreaPx2;
}

using Vector8d = Eigen::Matrix<double, 8, 1>;
/// A system with up to 8 unknowns. All systems have this type, because a decomposition takes the compiler seconds.
using EightEquations = Eigen::Matrix<double, 8, Eigen::Dynamic, 0, 8, 8>;

Eigen::VectorXd least_squares(const EightEquations& a, const Vector8d& b) { return a.colPivHouseholderQr().solve(b); }

/// Returns the homography from the tag's plane, in metres, to normalised image coordinates. It is exact for four
/// points.
std::optional<Matrix3d> homography_of(const Corners3& tag, const Corners2& rays) {
  EightEquations a = EightEquations::Zero(8, 8);
  Vector8d b;
  for (Eigen::Index i = 0; i < 4; ++i) {
    const double x = tag[static_cast<std::size_t>(i)].x();
    const double y = tag[static_cast<std::size_t>(i)].y();
    const Vector2d& ray = rays[static_cast<std::size_t>(i)];
    a.row(2 * i) << x, y, 1, 0, 0, 0, -ray.x() * x, -ray.x() * y;
    a.row(2 * i + 1) << 0, 0, 0, x, y, 1, -ray.y() * x, -ray.y() * y;
    b.segment<2>(2 * i) = ray;
  }
  const Vector8d h = least_squares(a, b);
  if (!h.allFinite()) return std::nullopt;
  Matrix3d homography;
  homography << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], 1.0;
  return homography;
}

/// Returns both rotations that agree with the homography's derivative at the tag's centre (Collins and Bartoli, section
/// 4).
std::optional<std::array<Matrix3d, 2>> rotations_of(const Matrix3d& h) {
  const Vector2d centre(h(0, 2), h(1, 2));  // h(2, 2) is 1.
  const Matrix2d jacobian = h.topLeftCorner<2, 2>() - centre * h.block<1, 2>(2, 0);
  const Matrix3d turned =
      Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), Vector3d(centre.x(), centre.y(), 1.0)).toRotationMatrix();
  const Matrix2d b = turned.topLeftCorner<2, 2>() - centre * turned.block<1, 2>(2, 0);
  const Matrix2d a = b.inverse() * jacobian;
  // The larger singular value of a 2x2 matrix is half the sum of the sizes of its rotating and its mirroring part.
  const double scale =
      0.5 * (std::hypot(a(0, 0) + a(1, 1), a(1, 0) - a(0, 1)) + std::hypot(a(0, 0) - a(1, 1), a(1, 0) + a(0, 1)));
  if (!(std::isfinite(scale) && scale > 1e-12)) return std::nullopt;
  const Matrix2d r = a / scale;
  // The missing component of a unit column is its depth; its sign is free, but common to both columns.
  double p = std::sqrt(std::max(0.0, 1.0 - r.col(0).squaredNorm()));
  double q = std::sqrt(std::max(0.0, 1.0 - r.col(1).squaredNorm()));
  if (r.col(0).dot(r.col(1)) > 0.0) q = -q;
  std::array<Matrix3d, 2> rotations;
  for (Matrix3d& rotation : rotations) {
    const Vector3d x = Vector3d(r(0, 0), r(1, 0), p).normalized();
    const Vector3d z = x.cross(Vector3d(r(0, 1), r(1, 1), q)).normalized();
    Matrix3d columns;
    columns << x, z.cross(x), z;
    rotation = turned * columns;
    if (!rotation.allFinite()) return std::nullopt;
    p = -p;
    q = -q;
  }
  return rotations;
}

/// Returns the translation with the smallest algebraic error.
Vector3d translation_for(const Matrix3d& rotation, const Corners3& tag, const Corners2& rays) {
  EightEquations a(8, 3);
  Vector8d b;
  for (Eigen::Index i = 0; i < 4; ++i) {
    const Vector3d p = rotation * tag[static_cast<std::size_t>(i)];
    const Vector2d& ray = rays[static_cast<std::size_t>(i)];
    a.row(2 * i) << 1.0, 0.0, -ray.x();
    a.row(2 * i + 1) << 0.0, 1.0, -ray.y();
    b.segment<2>(2 * i) = ray * p.z() - p.head<2>();
  }
  return least_squares(a, b);
}

std::optional<TagPose> refine(const Matrix3d& rotation, const Corners3& tag, const Corners2& rays,
                              const Corners2& corners, const Pinhole& lens) {
  std::array<SeenPoint, 4> points;
  for (std::size_t i = 0; i < 4; ++i) points[i] = {tag[i], corners[i], Matrix2d::Identity()};
  return fit_pose(points, {Eigen::Quaterniond(rotation), translation_for(rotation, tag, rays)}, lens);
}

}  // namespace

std::array<Vector3d, 4> corners_of_tag(double tag_size_m) {
  const double half = 0.5 * tag_size_m;
  return {Vector3d(-half, -half, 0), Vector3d(half, -half, 0), Vector3d(half, half, 0), Vector3d(-half, half, 0)};
}

std::optional<TagPoses> estimate_poses(const Corners2& corners, double tag_size_m, const Pinhole& lens) {
  CHECK(tag_size_m > 0.0 && lens.focal_px > 0.0);
  if (!is_usable(corners)) return std::nullopt;
  const Corners3 tag = corners_of_tag(tag_size_m);
  Corners2 rays;
  for (std::size_t i = 0; i < 4; ++i) rays[i] = lens.direction_at(corners[i].x(), corners[i].y()).head<2>();
  const auto homography = homography_of(tag, rays);
  if (!homography) return std::nullopt;
  const auto rotations = rotations_of(*homography);
  if (!rotations) return std::nullopt;
  std::optional<TagPose> first = refine((*rotations)[0], tag, rays, corners, lens);
  std::optional<TagPose> second = refine((*rotations)[1], tag, rays, corners, lens);
  if (!first || (second && second->reprojection_px < first->reprojection_px)) std::swap(first, second);
  if (!first) return std::nullopt;
  if (second && first->T_camera_tag.rotation().angularDistance(second->T_camera_tag.rotation()) < kSamePoseRad) {
    second.reset();
  }
  return TagPoses{*first, second};
}

}  // namespace cyclorama::tracker
