// SPDX-License-Identifier: Apache-2.0
/// One scan of an E57 file: its pose, and its points in packets. Source: ASTM E2807, clauses 8.4.4 and 9.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>

#include "common/base/result.h"
#include "renderfarm/scene/e57_bits.h"
#include "renderfarm/scene/e57_pages.h"
#include "renderfarm/scene/point_cloud.h"

namespace cyclorama::scene {

/// Reader of one scan. Borrows the file and the XML. Thread-bound.
class E57Scan {
 public:
  /// Opens `scan`, a child of data3D. Errors: kBadData if it has no points with positions.
  static Result<E57Scan> open(const E57Pages& pages, const E57Node& scan);

  [[nodiscard]] std::uint64_t point_count() const { return point_count_; }
  [[nodiscard]] bool has_colour() const { return has(kRed) && has(kGreen) && has(kBlue); }
  [[nodiscard]] bool has_intensity() const { return has(kIntensity); }
  /// Adds all valid points to `cloud`. Errors: kBadData if packets are damaged or contain too few points.
  Status read(PointCloud* cloud) &&;

 private:
  enum Role : std::size_t {
    kX,
    kY,
    kZ,
    kRange,
    kAzimuth,
    kElevation,
    kRed,
    kGreen,
    kBlue,
    kIntensity,
    kInvalid,
    kRoles
  };
  static constexpr std::size_t kAbsent = static_cast<std::size_t>(-1);
  struct Limits {
    double minimum = 0.0;
    double maximum = 1.0;
  };

  E57Scan(const E57Pages& pages, const E57Node& scan) : pages_(pages), scan_(scan) { role_.fill(kAbsent); }
  [[nodiscard]] bool has(Role role) const { return role_[role] != kAbsent; }
  Status read_prototype(const E57Node& points);
  void read_pose();
  [[nodiscard]] Limits limits_of(Role role, const char* group, const char* name) const;
  Status take_packet(std::span<const std::byte> packet);
  void add_point(const std::vector<double>& row, PointCloud* cloud) const;
  [[nodiscard]] PointCloud::Colour colour_of(const std::vector<double>& row) const;

  const E57Pages& pages_;
  const E57Node& scan_;
  std::uint64_t section_ = 0;  ///< Offset, in the content, of the section with the packets.
  std::uint64_t point_count_ = 0;
  std::vector<E57Field> fields_;
  std::array<std::size_t, kRoles> role_{};  ///< Index of the field of each role.
  std::array<Limits, 4> brightness_;        ///< Limits of red, green, blue and intensity.
  Eigen::Isometry3d T_file_scan_ = Eigen::Isometry3d::Identity();
};

}  // namespace cyclorama::scene
