// SPDX-License-Identifier: Apache-2.0
/// Header of a PLY file. Source: G. Turk, "The PLY Polygon File Format", 1994, and the dialects of Blender,
/// VCGLIB/MeshLab, CloudCompare and Assimp.
///
/// This reader exists because the only PLY library in Debian is Assimp, which keeps positions in float, reads each
/// value through virtual calls, and needs many times the file's size in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/base/result.h"

namespace cyclorama::scene {

enum class PlyType : std::uint8_t { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };
enum class PlyEncoding : std::uint8_t { kAscii, kLittleEndian, kBigEndian };

[[nodiscard]] std::size_t size_of(PlyType type);
[[nodiscard]] inline bool is_float(PlyType type) { return type == PlyType::kFloat32 || type == PlyType::kFloat64; }

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat32;   ///< Type of the value, or of each value of a list.
  std::optional<PlyType> count_type;  ///< Type of the count; only for lists.
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  /// Returns the minimum size in bytes of one row in the file, with empty lists.
  [[nodiscard]] std::size_t min_row_bytes(PlyEncoding encoding) const;
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::kAscii;
  std::vector<PlyElement> elements;        ///< In file order; each has at least one property.
  std::size_t stray_lines = 0;             ///< Number of skipped lines, which are not part of PLY.
  std::vector<std::string> texture_files;  ///< MeshLab's "comment TextureFile" lines, in order; may be empty.
  std::size_t body_offset = 0;
  std::size_t body_line = 1;  ///< Line number of the first line of an ASCII body.
};

/// Reads the header; its counts may be trusted for reserving memory. A line that does not begin with a keyword of PLY
/// and declares nothing is skipped. Errors: kBadData, with the line, if `file` has no PLY header or announces more rows
/// than it can contain. Reentrant.
Result<PlyHeader> parse_ply_header(std::span<const std::byte> file);

}  // namespace cyclorama::scene
