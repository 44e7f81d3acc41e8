// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/las_header.h"

#include <fmt/format.h>

#include <array>
#include <cstring>

#include "renderfarm/scene/little_endian.h"

namespace cyclorama::scene {
namespace {

// Offsets of the header's fields.
constexpr std::size_t kMinor = 25;
constexpr std::size_t kFirstPoint = 96;
constexpr std::size_t kFormat = 104;
constexpr std::size_t kPointBytes = 105;
constexpr std::size_t kOldCount = 107;
constexpr std::size_t kScale = 131;
constexpr std::size_t kOffset = 155;
constexpr std::size_t kLasHeaderBytes = 227;
constexpr std::size_t kCount14 = 247;
constexpr std::size_t kLasHeaderBytes14 = 375;

struct PointFormat {
  std::size_t bytes;
  std::size_t colour_offset;
};
constexpr std::array<PointFormat, 11> kFormats = {
    {{20, 0}, {28, 0}, {26, 20}, {34, 28}, {57, 0}, {63, 28}, {30, 0}, {36, 30}, {38, 30}, {59, 0}, {67, 30}}};

Error bad_las(std::string what) { return Error(ErrorCode::kBadData, std::move(what)); }

}  // namespace

Result<LasHeader> parse_las_header(std::span<const std::byte> file) {
  if (file.size() < kLasHeaderBytes || std::memcmp(file.data(), "LASF", 4) != 0) {
    return bad_las("this is not a LAS file: it has no header of LAS; copy it again");
  }
  const auto minor = little_endian<std::uint8_t>(file, kMinor);
  const auto format = little_endian<std::uint8_t>(file, kFormat);
  // LAZ marks compression by the two highest bits of the format.
  if (format >= 0x40) {
    return bad_las(
        "its points are compressed (LAZ or COPC), which cannot be read on this system; convert it to LAS, "
        "for example with 'las2las -i scan.laz -o scan.las' or 'pdal translate scan.laz scan.las'");
  }
  if (format >= kFormats.size()) return bad_las(fmt::format("its points have the format {}; 0 to 10 exist", format));
  LasHeader header;
  header.format = format;
  header.colour_offset = kFormats[format].colour_offset;
  header.point_bytes = little_endian<std::uint16_t>(file, kPointBytes);
  header.first_point = little_endian<std::uint32_t>(file, kFirstPoint);
  header.point_count = little_endian<std::uint32_t>(file, kOldCount);
  if (minor >= 4 && file.size() >= kLasHeaderBytes14) header.point_count = little_endian<std::uint64_t>(file, kCount14);
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t at = sizeof(double) * static_cast<std::size_t>(axis);
    header.scale[axis] = little_endian<double>(file, kScale + at);
    header.offset[axis] = little_endian<double>(file, kOffset + at);
  }
  if (!header.scale.allFinite() || !header.offset.allFinite()) return bad_las("its scale or offset is not finite");
  if (header.point_bytes < kFormats[format].bytes) {
    return bad_las(fmt::format("its points have {} bytes each; format {} needs {}", header.point_bytes, format,
                               kFormats[format].bytes));
  }
  if (header.first_point < kLasHeaderBytes || header.first_point > file.size()) {
    return bad_las(fmt::format("its points begin at byte {} of {}", header.first_point, file.size()));
  }
  const std::size_t room = (file.size() - header.first_point) / header.point_bytes;
  if (header.point_count > room) {
    return bad_las(fmt::format("the header announces {} points, but the file holds {}: it is cut short; copy it again",
                               header.point_count, room));
  }
  return header;
}

}  // namespace cyclorama::scene
