// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "common/base/file.h"
#include "renderfarm/scene/las_header.h"
#include "renderfarm/scene/little_endian.h"
#include "renderfarm/scene/mesh_repair.h"
#include "renderfarm/scene/model.h"
#include "renderfarm/scene/point_cloud.h"

namespace cyclorama::scene {
namespace {

constexpr std::size_t kIntensity = 12;
/// Offset of the flags in formats 6 and up; in lower formats this byte contains the class and the flags.
constexpr std::size_t kFlags = 15;
constexpr std::size_t kClass = 16;  ///< Offset of the class in formats 6 and up.

/// Access to the points of a file by number. Borrows the file.
class LasPoints {
 public:
  LasPoints(std::span<const std::byte> file, const LasHeader& header) : file_(file), header_(header) {}

  [[nodiscard]] Eigen::Vector3d position(std::uint64_t point) const {
    const std::size_t at = offset_of(point);
    const Eigen::Vector3d steps(little_endian<std::int32_t>(file_, at), little_endian<std::int32_t>(file_, at + 4),
                                little_endian<std::int32_t>(file_, at + 8));
    return header_.scale.cwiseProduct(steps) + header_.offset;
  }
  [[nodiscard]] std::uint16_t intensity(std::uint64_t point) const {
    return little_endian<std::uint16_t>(file_, offset_of(point) + kIntensity);
  }
  /// Precondition: the format has colours.
  [[nodiscard]] std::array<std::uint16_t, 3> colour(std::uint64_t point) const {
    const std::size_t at = offset_of(point) + header_.colour_offset;
    return {little_endian<std::uint16_t>(file_, at), little_endian<std::uint16_t>(file_, at + 2),
            little_endian<std::uint16_t>(file_, at + 4)};
  }
  /// Returns true if the scanner or an editor marked the point as wrong: as withheld, or as noise (classes 7 and 18).
  [[nodiscard]] bool is_marked_wrong(std::uint64_t point) const {
    const std::size_t at = offset_of(point);
    const auto flags = little_endian<std::uint8_t>(file_, at + kFlags);
    const bool is_new = header_.format >= 6;
    const bool is_withheld = (flags & (is_new ? 0x04 : 0x80)) != 0;
    const int kind = is_new ? little_endian<std::uint8_t>(file_, at + kClass) : flags & 0x1f;
    return is_withheld || kind == 7 || kind == 18;
  }

 private:
  [[nodiscard]] std::size_t offset_of(std::uint64_t point) const {
    return header_.first_point + point * header_.point_bytes;
  }
  std::span<const std::byte> file_;
  const LasHeader& header_;
};

/// Colours of the points: the file's colours, else intensities, else white.
class LasColours {
 public:
  LasColours(const LasPoints& points, const LasHeader& header) : points_(points) {
    if (header.colour_offset > 0) {
      bool has_large = false;
      for (std::uint64_t i = 0; i < header.point_count; ++i) {
        for (const std::uint16_t channel : points.colour(i)) {
          has_colour_ = has_colour_ || channel > 0;
          has_large = has_large || channel > 255;
        }
      }
      // Colours have 16 bits by the specification, but many programs write bytes.
      colour_factor_ = has_large ? 1.0 / 257.0 : 1.0;
    }
    if (has_colour_) return;
    BrightnessScale scale;
    for (std::uint64_t i = 0; i < header.point_count; ++i) scale.count(points.intensity(i));
    has_intensity_ = scale.has_any();
    intensity_factor_ = scale.factor();
  }

  [[nodiscard]] PointCloud::Colour of(std::uint64_t point) const {
    if (has_colour_) {
      const std::array<std::uint16_t, 3> colour = points_.colour(point);
      return {to_byte(colour_factor_ * colour[0]), to_byte(colour_factor_ * colour[1]),
              to_byte(colour_factor_ * colour[2])};
    }
    PointCloud::Colour grey;
    grey.fill(has_intensity_ ? to_byte(intensity_factor_ * points_.intensity(point)) : std::uint8_t{255});
    return grey;
  }
  [[nodiscard]] bool is_intensity() const { return !has_colour_ && has_intensity_; }

 private:
  const LasPoints& points_;
  bool has_colour_ = false;
  bool has_intensity_ = false;
  double colour_factor_ = 1.0;
  double intensity_factor_ = 1.0;
};

Result<Model> import_las_bytes(std::span<const std::byte> file, const ImportLimits& limits) {
  TRY_ASSIGN(const LasHeader header, parse_las_header(file));
  PointCloud cloud(limits.memory_bytes);
  TRY(cloud.check_memory(header.point_count));
  const LasPoints points(file, header);
  const LasColours colours(points, header);
  std::uint64_t wrong = 0;
  for (std::uint64_t i = 0; i < header.point_count; ++i) {
    if (points.is_marked_wrong(i)) {
      ++wrong;
    } else {
      cloud.add(points.position(i), colours.of(i));
    }
  }
  std::vector<std::string> notes;
  if (wrong > 0) notes.push_back(fmt::format("{} points are marked as noise or withheld: left out", wrong));
  if (colours.is_intensity()) notes.emplace_back("the points have no colours: shown by their intensity");
  return std::move(cloud).finish(std::move(notes));
}

}  // namespace

Result<Model> import_las(const std::filesystem::path& path, const ImportLimits& limits) {
  TRY_ASSIGN(const MappedFile file, MappedFile::open(path));
  Result<Model> model = import_las_bytes(file.bytes(), limits);
  if (!model) return std::move(model).error().while_doing(fmt::format("'{}'", path.string()));
  return model;
}

}  // namespace cyclorama::scene
