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

/// Returns the material for files without materials: matte and double-sided, because scans are often open at the back.
[[nodiscard]] Material scan_material();

/// Replaces the points of `cloud` by squares (point_squares.h), and notes their number and spacing. `bytes_per_point`
/// is the memory of each point in the cloud. Errors: kBadData if there are no points, or if the conversion needs more
/// than `limit_bytes`.
Status show_points(std::size_t bytes_per_point, std::size_t limit_bytes, Mesh* cloud, std::vector<std::string>* notes);

/// The points of a scanner's file. Thread-bound.
class PointCloud {
 public:
  using Colour = std::array<std::uint8_t, 3>;

  explicit PointCloud(std::size_t limit_bytes) : limit_bytes_(limit_bytes) {}

  /// Checks that `count` points fit into the limit; to be called before they are added. Errors: kBadData if they do
  /// not.
  [[nodiscard]] Status check_memory(std::uint64_t count) const;
  /// Adds a point of a file whose z axis points up; points that are not finite are left out and counted.
  void add(const Eigen::Vector3d& p_z_up, const Colour& colour);
  /// Returns the number of points that were added, including those that are not finite.
  [[nodiscard]] std::uint64_t added() const { return mesh_.positions.size() + unusable_; }

  /// Returns the points as a scan. Errors: kBadData if there are none.
  Result<Model> finish(std::vector<std::string> notes) &&;

 private:
  std::size_t limit_bytes_;
  std::uint64_t unusable_ = 0;
  Mesh mesh_;
};

/// Factor that converts colours or intensities to bytes, from a histogram of all values, because files use any range.
/// The value that only one in fifty exceeds becomes white.
class BrightnessScale {
 public:
  void count(std::uint16_t value) { ++histogram_[value]; }
  [[nodiscard]] bool has_any() const;
  [[nodiscard]] double factor() const;

 private:
  std::vector<std::uint64_t> histogram_ = std::vector<std::uint64_t>(1u << 16);
};

}  // namespace cyclorama::scene
