// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_skin.h"

#include <fmt/format.h>

#include <cmath>

#include "renderfarm/scene/mesh_repair.h"

namespace cyclorama::scene {
namespace {

constexpr int kMatrixWidth = 16;

Result<Eigen::Affine3d> affine_of(const std::array<float, kMatrixWidth>& columns, const GltfAccessor& accessor) {
  const Eigen::Matrix4d matrix = Eigen::Map<const Eigen::Matrix4f>(columns.data()).cast<double>();
  const bool is_affine = matrix.allFinite() && matrix.row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1), 1e-4);
  if (!is_affine) return gltf_damaged(accessor.place, "an inverse bind matrix is not affine");
  Eigen::Affine3d T = Eigen::Affine3d::Identity();
  T.matrix().topRows<3>() = matrix.topRows<3>();
  return T;
}

Eigen::Vector3f moved(const Eigen::Matrix3d& linear, const float* xyz) {
  const Eigen::Vector3d direction = linear * Eigen::Map<const Eigen::Vector3f>(xyz).cast<double>();
  const double length = direction.norm();
  return length > 0.0 && std::isfinite(length) ? Eigen::Vector3f((direction / length).cast<float>())
                                               : Eigen::Vector3f(Eigen::Vector3f::Zero());
}

/// Returns the weighted mean of the transforms of a vertex's joints.
Eigen::Affine3d mean_pose(const std::array<std::uint16_t, 4>& joints, const std::array<float, 4>& weights,
                          const std::vector<Eigen::Affine3d>& pose) {
  Eigen::Affine3d T;
  T.matrix().setZero();
  for (std::size_t k = 0; k < 4; ++k) {
    if (weights[k] > 0.0f) T.matrix() += double{weights[k]} * pose[joints[k]].matrix();
  }
  T.makeAffine();
  return T;
}

}  // namespace

Result<GltfSkinning> read_skinning(const GltfAccessor& joints, const GltfAccessor& weights,
                                   const GltfSelection& selection, GltfBudget* budget) {
  TRY(budget->take(joints.place, selection.size(), sizeof(std::array<float, 4>) * 2 + sizeof(std::array<int, 2>)));
  const std::vector<std::array<float, 4>> numbers = read_floats<4>(joints, selection);
  GltfSkinning skinning;
  skinning.weights = read_floats<4>(weights, selection);
  skinning.joints.reserve(numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    std::array<std::uint16_t, 4>& of_vertex = skinning.joints.emplace_back();
    float sum = 0.0f;
    for (std::size_t k = 0; k < 4; ++k) {
      of_vertex[k] = static_cast<std::uint16_t>(numbers[i][k]);
      float& weight = skinning.weights[i][k];
      if (!(weight > 0.0f) || !std::isfinite(weight)) weight = 0.0f;
      sum += weight;
    }
    if (sum == 0.0f) skinning.weights[i][0] = sum = 1.0f;
    for (float& weight : skinning.weights[i]) weight /= sum;
  }
  return skinning;
}

Result<std::vector<Eigen::Affine3d>> read_pose(GltfDocument* document, const GltfObject& skin,
                                               const std::vector<Eigen::Affine3d>& T_model_node, GltfBudget* budget) {
  TRY_ASSIGN(const GltfArray joints, skin.array("joints"));
  if (joints.size() == 0) return skin.damaged("joints", "is missing or empty");
  std::vector<Eigen::Affine3d> pose;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    TRY_ASSIGN(const std::uint64_t node, joints.integer(i));
    if (node >= T_model_node.size()) {
      return gltf_damaged(joints.place_of(i), fmt::format("index {} of {} nodes", node, T_model_node.size()));
    }
    pose.push_back(T_model_node[node]);
  }
  TRY_ASSIGN(const std::optional<std::size_t> index, document->index(skin, "inverseBindMatrices", "accessors"));
  if (!index) return pose;
  TRY_ASSIGN(const GltfAccessor matrices, read_accessor(document, *index, budget));
  if (matrices.width != kMatrixWidth || matrices.component != GltfComponent::kF32 || matrices.count < pose.size()) {
    return gltf_damaged(matrices.place, fmt::format("{} matrices of 4 x 4 floats are needed here", pose.size()));
  }
  const auto columns = read_floats<kMatrixWidth>(matrices, GltfSelection::all(pose.size()));
  for (std::size_t i = 0; i < pose.size(); ++i) {
    TRY_ASSIGN(const Eigen::Affine3d T_joint_mesh, affine_of(columns[i], matrices));
    pose[i] = pose[i] * T_joint_mesh;
    if (!pose[i].matrix().allFinite()) return gltf_damaged(matrices.place, "the pose of a joint is too large");
  }
  return pose;
}

Status apply_pose(const GltfSkinning& skinning, const std::vector<Eigen::Affine3d>& pose, const std::string& place,
                  Mesh* mesh) {
  for (std::size_t i = 0; i < mesh->positions.size(); ++i) {
    for (std::size_t k = 0; k < 4; ++k) {
      if (skinning.weights[i][k] == 0.0f || skinning.joints[i][k] < pose.size()) continue;
      return gltf_damaged(place,
                          fmt::format("vertex {} follows joint {} of {}", i, skinning.joints[i][k], pose.size()));
    }
    const Eigen::Affine3d T = mean_pose(skinning.joints[i], skinning.weights[i], pose);
    const Eigen::Vector3f p = Eigen::Map<const Eigen::Vector3f>(mesh->positions[i].data());
    const Eigen::Vector3d q = T * p.cast<double>();
    if (!is_usable(q)) return gltf_damaged(place, "the rest pose is too large");
    mesh->positions[i] = {static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z())};
    if (!mesh->normals.empty()) {
      const Eigen::Vector3f n = moved(T.linear().inverse().transpose(), mesh->normals[i].data());
      mesh->normals[i] = {finite_float(double{n.x()}), finite_float(double{n.y()}), finite_float(double{n.z()})};
    }
    if (!mesh->tangents.empty()) {
      const Eigen::Vector3f t = moved(T.linear(), mesh->tangents[i].data());
      mesh->tangents[i] = {t.x(), t.y(), t.z(), mesh->tangents[i][3]};
    }
  }
  if (!mesh->normals.empty()) repair_normals(mesh);
  return Done{};
}

}  // namespace cyclorama::scene
