// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/tag_pose.h"

extern "C" {
#include <apriltag/apriltag_pose.h>
#include <apriltag/common/homography.h>
}

#include <Eigen/Dense>
#include <cmath>
#include <memory>
#include <utility>

#include "common/base/check.h"

namespace cyclorama {
namespace {

/// libapriltag's own number; more changes nothing that a corner's noise would not hide.
constexpr int kIterations = 50;
/// Below this a quadrilateral is a line or a point to a camera.
constexpr double kLeastDoubledAreaPx2 = 2.0;
/// Two minima that differ by less are one.
constexpr double kSamePoseRad = 1e-3;

struct DestroyMatrix { void operator()(matd_t* matrix) const { matd_destroy(matrix); } };
using Matrix = std::unique_ptr<matd_t, DestroyMatrix>;

bool is_convex(const std::array<Eigen::Vector2d, 4>& corners) {
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d a = corners[(i + 1) % 4] - corners[i];
    const Eigen::Vector2d b = corners[(i + 2) % 4] - corners[(i + 1) % 4];
    if (!(a.x() * b.y() - a.y() * b.x() > 0.0)) return false;
  }
  return true;
}

/// From the corners of (-1, -1) to (1, 1) to the picture: exact for four points.
Matrix homography_of(const std::array<Eigen::Vector2d, 4>& corners) {
  constexpr std::array<std::array<double, 2>, 4> kUnit{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
  Eigen::Matrix<double, 8, 8> a = Eigen::Matrix<double, 8, 8>::Zero();
  Eigen::Matrix<double, 8, 1> b;
  for (Eigen::Index i = 0; i < 4; ++i) {
    const auto [x, y] = kUnit[static_cast<std::size_t>(i)];
    const Eigen::Vector2d& corner = corners[static_cast<std::size_t>(i)];
    a.row(2 * i) << x, y, 1, 0, 0, 0, -corner.x() * x, -corner.x() * y;
    a.row(2 * i + 1) << 0, 0, 0, x, y, 1, -corner.y() * x, -corner.y() * y;
    b.segment<2>(2 * i) = corner;
  }
  const Eigen::Matrix<double, 8, 1> h = a.fullPivLu().solve(b);
  if (!h.allFinite()) return nullptr;
  Matrix matrix(matd_create(3, 3));
  for (unsigned i = 0; i < 8; ++i) matd_put(matrix.get(), i / 3, i % 3, h[i]);
  matd_put(matrix.get(), 2, 2, 1.0);
  return matrix;
}

std::optional<TagPose> checked(const Matrix& r, const Matrix& t, const std::array<Eigen::Vector2d, 4>& corners,
                               double tag_size_m, const Pinhole& lens) {
  if (r == nullptr || t == nullptr) return std::nullopt;
  const Eigen::Matrix3d rotation = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(r->data);
  const Eigen::Vector3d translation = Eigen::Map<const Eigen::Vector3d>(t->data);
  if (!rotation.allFinite() || !translation.allFinite() || !(rotation.determinant() > 0.5)) return std::nullopt;
  TagPose pose{{Eigen::Quaterniond(rotation), translation}, 0.0};
  const std::array<Eigen::Vector3d, 4> tag = corners_of_tag(tag_size_m);
  double sum = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto pixel = lens.pixel_of((pose.T_camera_tag * Point<frame::Tag>{tag[i]}).xyz);
    if (!pixel) return std::nullopt;
    sum += (*pixel - corners[i]).squaredNorm();
  }
  pose.reprojection_px = std::sqrt(sum / 4.0);
  return pose;
}

}  // namespace

std::array<Eigen::Vector3d, 4> corners_of_tag(double tag_size_m) {
  const double half = 0.5 * tag_size_m;
  return {Eigen::Vector3d(-half, -half, 0), Eigen::Vector3d(half, -half, 0), Eigen::Vector3d(half, half, 0),
          Eigen::Vector3d(-half, half, 0)};
}

std::optional<TagPoses> estimate_poses(const std::array<Eigen::Vector2d, 4>& corners, double tag_size_m,
                                       const Pinhole& lens) {
  CHECK(tag_size_m > 0.0 && lens.focal_px > 0.0);
  for (const Eigen::Vector2d& corner : corners) {
    if (!corner.allFinite()) return std::nullopt;
  }
  if (!(doubled_area_px2(corners) > kLeastDoubledAreaPx2) || !is_convex(corners)) return std::nullopt;
  const Matrix homography = homography_of(corners);
  if (homography == nullptr) return std::nullopt;

  apriltag_detection_t detection{};
  detection.H = homography.get();
  for (std::size_t i = 0; i < 4; ++i) {  // libapriltag's order is the reverse of ours.
    detection.p[i][0] = corners[3 - i].x();
    detection.p[i][1] = corners[3 - i].y();
  }
  apriltag_detection_info_t info{&detection, tag_size_m, lens.focal_px, lens.focal_px, lens.centre_u_px, lens.centre_v_px};
  std::array<double, 2> object_space_error{};
  std::array<apriltag_pose_t, 2> raw{};
  estimate_tag_pose_orthogonal_iteration(&info, &object_space_error[0], &raw[0], &object_space_error[1], &raw[1],
                                         kIterations);
  std::array<std::optional<TagPose>, 2> poses;
  for (std::size_t i = 0; i < 2; ++i) {
    const Matrix r(raw[i].R);
    const Matrix t(raw[i].t);
    poses[i] = checked(r, t, corners, tag_size_m, lens);
  }
  if (!poses[0] || (poses[1] && poses[1]->reprojection_px < poses[0]->reprojection_px)) std::swap(poses[0], poses[1]);
  if (!poses[0]) return std::nullopt;
  if (poses[1] && poses[0]->T_camera_tag.rotation().angularDistance(poses[1]->T_camera_tag.rotation()) < kSamePoseRad) {
    poses[1].reset();
  }
  return TagPoses{*poses[0], poses[1]};
}

}  // namespace cyclorama
