// SPDX-License-Identifier: Apache-2.0
/// Destination of generated geometry. The program writes PLY files; tests only count vertices and triangles.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "common/base/result.h"

namespace cyclorama::generator {

struct Vertex {
  std::array<float, 3> position;       ///< Metres.
  std::array<float, 3> normal;         ///< Unit length.
  std::array<std::uint8_t, 3> colour;  ///< sRGB.
};
using Triangle = std::array<std::uint32_t, 3>;

struct GeometryCounts {
  std::uint64_t vertices = 0;
  std::uint64_t triangles = 0;
};

/// One file. Callers add exactly the announced vertices, then exactly the announced triangles, and then call finish().
/// Thread-bound.
class GeometryFile {
 public:
  virtual ~GeometryFile() = default;
  virtual Status add_vertices(std::span<const Vertex> vertices) = 0;
  virtual Status add_triangles(std::span<const Triangle> triangles) = 0;
  virtual Status finish() = 0;
};

/// Creates files. Thread-safe: several files may be open at a time, each used by one thread.
class GeometrySink {
 public:
  virtual ~GeometrySink() = default;
  virtual Result<std::unique_ptr<GeometryFile>> open(const std::string& name, const GeometryCounts& counts) = 0;
};

}  // namespace cyclorama::generator
