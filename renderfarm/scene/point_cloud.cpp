// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/point_cloud.h"

#include <fmt/format.h>

#include <limits>
#include <numeric>
#include <utility>

#include "renderfarm/scene/mesh_repair.h"
#include "renderfarm/scene/point_squares.h"

namespace cyclorama::scene {
namespace {

constexpr std::size_t kBytesPerPoint = 12 + 4;  ///< Position and colour.

Status check_points(std::uint64_t count, std::size_t bytes_per_point, std::size_t limit_bytes) {
  constexpr std::uint64_t kMaxPoints = std::numeric_limits<std::uint32_t>::max() / 4;  // A square has four corners.
  if (count <= kMaxPoints && count <= limit_bytes / (bytes_per_point + kSquareBytes)) return Done{};
  return Error(
      ErrorCode::kBadData,
      fmt::format("its {} points need more than the {} MiB that a scene may take; raise the limit, or thin the "
                  "points out",
                  count, limit_bytes >> 20));
}

}  // namespace

Material scan_material() {
  Material material;
  material.name = "scan";
  material.metallic = 0.0f;
  material.roughness = 1.0f;
  material.double_sided = true;
  return material;
}

Status show_points(std::size_t bytes_per_point, std::size_t limit_bytes, Mesh* cloud, std::vector<std::string>* notes) {
  const std::size_t count = cloud->positions.size();
  if (count == 0) return Error(ErrorCode::kBadData, "it holds neither triangles nor points with finite places");
  TRY(check_points(count, bytes_per_point, limit_bytes));
  const double step = make_point_squares(cloud);
  notes->push_back(
      fmt::format("{} points without triangles, about {:.3g} units apart: shown as small squares", count, step));
  return Done{};
}

Status PointCloud::check_memory(std::uint64_t count) const {
  return check_points(mesh_.positions.size() + count, kBytesPerPoint, limit_bytes_);
}

void PointCloud::add(const Eigen::Vector3d& p_z_up, const Colour& colour) {
  const Eigen::Vector3d p(p_z_up.x(), p_z_up.z(), -p_z_up.y());
  if (!is_usable(p)) {
    ++unusable_;
    return;
  }
  if (mesh_.positions.empty()) mesh_.origin = origin_near(p);
  const Eigen::Vector3f near_origin = (p - mesh_.origin).cast<float>();
  mesh_.positions.push_back({near_origin.x(), near_origin.y(), near_origin.z()});
  mesh_.colours.push_back({colour[0], colour[1], colour[2], 255});
}

Result<Model> PointCloud::finish(std::vector<std::string> notes) && {
  if (unusable_ > 0) notes.push_back(fmt::format("{} points are not finite: left out", unusable_));
  TRY(show_points(kBytesPerPoint, limit_bytes_, &mesh_, &notes));
  Model model;
  model.notes = std::move(notes);
  model.materials.push_back(scan_material());
  model.meshes.push_back(std::move(mesh_));
  model.instances.push_back({0, Eigen::Affine3d::Identity()});
  return model;
}

bool BrightnessScale::has_any() const {
  return std::accumulate(histogram_.begin() + 1, histogram_.end(), std::uint64_t{0}) > 0;
}

double BrightnessScale::factor() const {
  constexpr std::uint64_t kBrighterParts = 50;
  const std::uint64_t all = std::accumulate(histogram_.begin(), histogram_.end(), std::uint64_t{0});
  std::uint64_t brighter = 0;
  std::size_t white = histogram_.size() - 1;
  while (white > 1 && (brighter += histogram_[white]) * kBrighterParts < all) --white;
  return 255.0 / static_cast<double>(white);
}

}  // namespace cyclorama::scene
