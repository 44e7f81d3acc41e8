// SPDX-License-Identifier: Apache-2.0
/// Binary PLY, little-endian, written as it comes: float x y z, nx ny nz if smooth, uchar red green blue; faces
/// of three int.
/// Source: G. Turk, "The PLY Polygon File Format", 1994.
#pragma once

#include <filesystem>

#include "renderfarm/generator/geometry_sink.h"

namespace cyclorama::grotto {

/// Flat: the file has no normals, and whoever reads it takes the triangles'.
enum class Shading { kSmooth, kFlat };

/// The size of the file that these counts make.
[[nodiscard]] std::uint64_t ply_bytes(const GeometryCounts& counts, Shading shading);

/// Makes files in one existing folder. kSystem when the disk is full or refuses, with the file's name.
class PlySink final : public GeometrySink {
 public:
  PlySink(std::filesystem::path folder, Shading shading) : folder_(std::move(folder)), shading_(shading) {}
  Result<std::unique_ptr<GeometryFile>> open(const std::string& name, const GeometryCounts& counts) override;

 private:
  std::filesystem::path folder_;
  Shading shading_;
};

}  // namespace cyclorama::grotto
