// SPDX-License-Identifier: Apache-2.0
/// Common parts of the readers of point clouds: LAS, E57, and PLY without faces.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// The material of a file without any: matte, and seen from behind as well, since scans are often open there.
[[nodiscard]] Material scan_material();

/// Replaces the points of `cloud` by squares (point_squares.h), and notes their number and spacing. `bytes_per_point` is
/// what the cloud holds of each. Errors: kBadData if there are none, or more than fit into `limit_bytes` meanwhile.
Status show_points(std::size_t bytes_per_point, std::size_t limit_bytes, Mesh* cloud, std::vector<std::string>* notes);

/// The points of a scanner's file. Thread-bound.
class PointCloud {
 public:
  using Colour = std::array<std::uint8_t, 3>;

  explicit PointCloud(std::size_t limit_bytes) : limit_bytes_(limit_bytes) {}

  /// To be called before `count` points are added. Errors: kBadData if they would need more memory than the limit.
  [[nodiscard]] Status check_memory(std::uint64_t count) const;
  /// Adds a point of a file whose z axis points up; points that are not finite are left out and counted.
  void add(const Eigen::Vector3d& p_z_up, const Colour& colour);
  /// Number of points that were added, with those that are not finite.
  [[nodiscard]] std::uint64_t added() const { return mesh_.positions.size() + unusable_; }

  /// Returns the points as a scan. Errors: kBadData if there are none.
  Result<Model> finish(std::vector<std::string> notes) &&;

 private:
  std::size_t limit_bytes_;
  std::uint64_t unusable_ = 0;
  Mesh mesh_;
};

/// The factor that brings colours or intensities to bytes, from a histogram of all their values: files state any range.
/// Takes the value that all but one in fifty are below as white.
class BrightnessScale {
 public:
  void count(std::uint16_t value) { ++histogram_[value]; }
  [[nodiscard]] bool has_any() const;
  [[nodiscard]] double factor() const;

 private:
  std::vector<std::uint64_t> histogram_ = std::vector<std::uint64_t>(1u << 16);
};

}  // namespace cyclorama::scene
