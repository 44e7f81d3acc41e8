// SPDX-License-Identifier: Apache-2.0
#include "appliance/camera_calibration/procam_start.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>

namespace cyclorama::camera_calibration {
namespace {

/// Points that are centred and scaled to a mean distance of 1, for well-conditioned linear equations.
template <int N>
struct Normalised {
  using Vector = Eigen::Matrix<double, N, 1>;
  using Transform = Eigen::Matrix<double, N + 1, N + 1>;
  std::vector<Vector> points;
  Transform transform = Transform::Identity();

  explicit Normalised(const std::vector<Vector>& given) {
    Vector middle = Vector::Zero();
    for (const Vector& p : given) middle += p / static_cast<double>(given.size());
    double size = 0.0;
    for (const Vector& p : given) size += (p - middle).norm() / static_cast<double>(given.size());
    const double scale = size > 0.0 ? 1.0 / size : 1.0;
    for (const Vector& p : given) points.push_back(scale * (p - middle));
    transform.template topLeftCorner<N, N>() *= scale;
    transform.template topRightCorner<N, 1>() = -scale * middle;
  }
};

/// Returns the null vector of a matrix; nothing if the null space has more than one dimension.
std::optional<Eigen::VectorXd> annulled(const Eigen::MatrixXd& rows) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(rows, Eigen::ComputeFullV);
  const Eigen::VectorXd& values = svd.singularValues();
  const Eigen::Index unknowns = rows.cols();
  if (rows.rows() < unknowns - 1 || !(values[unknowns - 2] > 1e-7 * values[0])) return std::nullopt;
  return Eigen::VectorXd(svd.matrixV().col(unknowns - 1));
}

}  // namespace

std::optional<Eigen::Matrix3d> homography(const std::vector<Eigen::Vector2d>& from,
                                          const std::vector<Eigen::Vector2d>& to) {
  if (from.size() < 4 || from.size() != to.size()) return std::nullopt;
  const Normalised<2> a(from);
  const Normalised<2> b(to);
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(2 * from.size()), 9);
  for (std::size_t i = 0; i < from.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(2 * i);
    const Eigen::RowVector3d p = a.points[i].homogeneous().transpose();
    rows.block<1, 3>(row, 0) = p;
    rows.block<1, 3>(row, 6) = -b.points[i].x() * p;
    rows.block<1, 3>(row + 1, 3) = p;
    rows.block<1, 3>(row + 1, 6) = -b.points[i].y() * p;
  }
  const auto h = annulled(rows);
  if (!h) return std::nullopt;
  const Eigen::Matrix3d normal = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(h->data());
  const Eigen::Matrix3d result = b.transform.inverse() * normal * a.transform;
  if (!result.allFinite()) return std::nullopt;
  return Eigen::Matrix3d(result / result.norm());
}

std::optional<double> focal_from(const std::vector<Eigen::Matrix3d>& homographies, const Eigen::Vector2d& centre_px) {
  // The first two columns are images of perpendicular directions of equal length, so each homography gives two linear
  // equations in 1/f².
  double sum_aa = 0.0;
  double sum_ac = 0.0;
  for (const Eigen::Matrix3d& h : homographies) {
    Eigen::Matrix3d moved = h;
    moved.row(0) -= centre_px.x() * h.row(2);
    moved.row(1) -= centre_px.y() * h.row(2);
    moved /= moved.leftCols<2>().norm();
    const Eigen::Vector3d p = moved.col(0);
    const Eigen::Vector3d q = moved.col(1);
    const double a1 = p.head<2>().dot(q.head<2>());
    const double c1 = p.z() * q.z();
    const double a2 = p.head<2>().squaredNorm() - q.head<2>().squaredNorm();
    const double c2 = p.z() * p.z() - q.z() * q.z();
    sum_aa += a1 * a1 + a2 * a2;
    sum_ac += a1 * c1 + a2 * c2;
  }
  const double inverse_square = -sum_ac / sum_aa;
  if (!(inverse_square > 0.0) || !std::isfinite(inverse_square)) return std::nullopt;
  return 1.0 / std::sqrt(inverse_square);
}

StartPose board_pose(const Eigen::Matrix3d& homography, double focal_px, const Eigen::Vector2d& centre_px) {
  Eigen::Matrix3d m = homography;
  m.row(0) = (homography.row(0) - centre_px.x() * homography.row(2)) / focal_px;
  m.row(1) = (homography.row(1) - centre_px.y() * homography.row(2)) / focal_px;
  m /= 0.5 * (m.col(0).norm() + m.col(1).norm());
  if (m(2, 2) < 0.0) m = -m;
  Eigen::Matrix3d axes;
  axes << m.col(0), m.col(1), m.col(0).cross(m.col(1));
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(axes, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d sign = Eigen::Matrix3d::Identity();
  sign(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  return {svd.matrixU() * sign * svd.matrixV().transpose(), m.col(2)};
}

std::optional<StartPinhole> pinhole_from(const std::vector<Eigen::Vector3d>& points,
                                         const std::vector<Eigen::Vector2d>& pixels) {
  if (points.size() < 6 || points.size() != pixels.size()) return std::nullopt;
  const Normalised<3> a(points);
  const Normalised<2> b(pixels);
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(2 * points.size()), 12);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(2 * i);
    const Eigen::RowVector4d p = a.points[i].homogeneous().transpose();
    rows.block<1, 4>(row, 0) = p;
    rows.block<1, 4>(row, 8) = -b.points[i].x() * p;
    rows.block<1, 4>(row + 1, 4) = p;
    rows.block<1, 4>(row + 1, 8) = -b.points[i].y() * p;
  }
  const auto values = annulled(rows);
  if (!values) return std::nullopt;
  const Eigen::Matrix<double, 3, 4> normal =
      Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(values->data());
  Eigen::Matrix<double, 3, 4> camera = b.transform.inverse() * normal * a.transform;
  // Chooses the scale and sign for which M contains a rotation with the points in front.
  camera /= camera.block<1, 3>(2, 0).norm();
  if (camera.leftCols<3>().determinant() < 0.0) camera = -camera;
  // M = K R, so K follows from M Mᵀ, beginning with its last row.
  const Eigen::Matrix3d m = camera.leftCols<3>();
  const Eigen::Matrix3d mm = m * m.transpose();
  const double cu = mm(0, 2) / mm(2, 2);
  const double cv = mm(1, 2) / mm(2, 2);
  const double ff = 0.5 * (mm(0, 0) - cu * cu + mm(1, 1) - cv * cv);
  if (!(ff > 0.0) || !std::isfinite(cu) || !std::isfinite(cv)) return std::nullopt;
  StartPinhole start;
  start.focal_px = std::sqrt(ff);
  start.centre_px = {cu, cv};
  Eigen::Matrix3d k;
  k << start.focal_px, 0.0, cu, 0.0, start.focal_px, cv, 0.0, 0.0, 1.0;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(k.inverse() * m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  start.pose.R = svd.matrixU() * svd.matrixV().transpose();
  start.pose.t = k.inverse() * camera.col(3);
  if (start.pose.R.determinant() < 0.0 || !start.pose.t.allFinite()) return std::nullopt;
  return start;
}

}  // namespace cyclorama::camera_calibration
