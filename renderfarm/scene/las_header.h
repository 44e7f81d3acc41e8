// SPDX-License-Identifier: Apache-2.0
/// Header of a LAS file. Source: ASPRS, "LAS Specification 1.4 - R15".
///
/// This reader exists because Debian 12 has neither liblas nor laszip, and uncompressed points are a simple table.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>

#include "common/base/result.h"

namespace cyclorama::scene {

struct LasHeader {
  std::uint8_t format = 0;        ///< Format of the points, 0 to 10.
  std::size_t point_bytes = 0;    ///< Distance between points, in bytes.
  std::size_t first_point = 0;    ///< Offset in the file.
  std::uint64_t point_count = 0;  ///< Number of points, all of which are in the file.
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  std::size_t colour_offset = 0;  ///< Offset in a point; 0 for formats without colours.
};

/// Reads the header. Errors: kBadData if `file` is not LAS, is compressed (LAZ, COPC), or announces more points than it
/// can contain. Reentrant.
Result<LasHeader> parse_las_header(std::span<const std::byte> file);

}  // namespace cyclorama::scene
