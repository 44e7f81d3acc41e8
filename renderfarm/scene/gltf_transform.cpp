// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_transform.h"

#include <array>
#include <cmath>
#include <optional>

namespace cyclorama::scene {
namespace {

Result<Eigen::Affine3d> from_matrix(const GltfObject& node, const std::array<double, 16>& columns) {
  const Eigen::Matrix4d matrix = Eigen::Map<const Eigen::Matrix4d>(columns.data());
  constexpr double kTolerance = 1e-6;  // Tolerates the rounding of exporters, which write floats.
  const Eigen::RowVector4d last_row(0.0, 0.0, 0.0, 1.0);
  if (!((matrix.row(3) - last_row).cwiseAbs().maxCoeff() <= kTolerance)) {
    return node.damaged("matrix", "its last row is not 0 0 0 1");
  }
  Eigen::Affine3d transform = Eigen::Affine3d::Identity();
  transform.matrix().topRows<3>() = matrix.topRows<3>();
  return transform;
}

}  // namespace

Result<Eigen::Affine3d> read_node_transform(const GltfObject& node, GltfNotes* notes) {
  TRY_ASSIGN(const auto matrix, node.numbers<16>("matrix"));
  TRY_ASSIGN(const auto translation, node.numbers<3>("translation"));
  TRY_ASSIGN(const auto rotation, node.numbers<4>("rotation"));
  TRY_ASSIGN(const auto scale, node.numbers<3>("scale"));
  if (matrix) {
    if (translation || rotation || scale)
      return node.damaged("matrix", "is given in addition to translation, rotation or scale");
    return from_matrix(node, *matrix);
  }
  const std::array<double, 3> t = translation.value_or(std::array{0.0, 0.0, 0.0});
  const std::array<double, 4> r = rotation.value_or(std::array{0.0, 0.0, 0.0, 1.0});
  const std::array<double, 3> s = scale.value_or(std::array{1.0, 1.0, 1.0});
  const Eigen::Vector4d quaternion(r[0], r[1], r[2], r[3]);
  constexpr double kUnitTolerance = 1e-2;
  if (!(std::abs(quaternion.norm() - 1.0) <= kUnitTolerance)) {
    notes->add("a rotation is not of unit length: its direction is used", node.place());
  }
  const std::optional<Eigen::Affine3d> transform =
      compose_transform({t[0], t[1], t[2]}, quaternion, {s[0], s[1], s[2]});
  if (!transform) return node.damaged("rotation", "is no rotation");
  return *transform;
}

std::optional<Eigen::Affine3d> compose_transform(const Eigen::Vector3d& translation, const Eigen::Vector4d& rotation,
                                                 const Eigen::Vector3d& scale) {
  const double length = rotation.norm();
  if (!(length > 0.0) || !std::isfinite(length)) return std::nullopt;
  const Eigen::Quaterniond q(rotation.w() / length, rotation.x() / length, rotation.y() / length,
                             rotation.z() / length);
  Eigen::Affine3d transform = Eigen::Affine3d::Identity();
  transform.linear() = q.toRotationMatrix() * scale.asDiagonal();
  transform.translation() = translation;
  return transform;
}

bool is_invertible(const Eigen::Affine3d& transform) {
  const Eigen::Matrix3d& m = transform.linear();
  const double volume = m.col(0).norm() * m.col(1).norm() * m.col(2).norm();
  if (!transform.matrix().allFinite() || !(volume > 0.0) || !std::isfinite(volume)) return false;
  constexpr double kFlattest = 1e-12;
  return std::abs(m.determinant()) > kFlattest * volume;
}

}  // namespace cyclorama::scene
