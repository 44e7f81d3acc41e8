// SPDX-License-Identifier: Apache-2.0
/// Writer of binary PLY, little-endian: float x y z, nx ny nz if smooth, uchar red green blue; faces of three int.
/// Source: G. Turk, "The PLY Polygon File Format", 1994.
#pragma once

#include <filesystem>

#include "renderfarm/generator/geometry_sink.h"

namespace cyclorama::generator {

/// With kFlat, the file has no normals, and readers use those of the triangles.
enum class Shading { kSmooth, kFlat };

/// Returns the size, in bytes, of a file with these counts.
[[nodiscard]] std::uint64_t ply_bytes(const GeometryCounts& counts, Shading shading);

/// Creates files in one existing folder. Errors: kSystem, with the file's name, if the disk is full or reports an
/// error.
class PlySink final : public GeometrySink {
 public:
  PlySink(std::filesystem::path folder, Shading shading) : folder_(std::move(folder)), shading_(shading) {}
  Result<std::unique_ptr<GeometryFile>> open(const std::string& name, const GeometryCounts& counts) override;

 private:
  std::filesystem::path folder_;
  Shading shading_;
};

}  // namespace cyclorama::generator
