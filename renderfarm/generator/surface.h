// SPDX-License-Identifier: Apache-2.0
/// Parametric patches: everything in a grotto is a grid of quads, computed row by row, so that memory does not grow
/// with the number of triangles.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "renderfarm/generator/geometry_sink.h"
#include "renderfarm/generator/vec.h"

namespace cyclorama::generator {

struct Surfel {
  Vec3 position;
  Vec3 colour;
};

/// One grid. `at` is a pure function of (u, v) in [0, 1]^2 and of the distance between vertices in metres, with which
/// it blurs the paint. A value; reentrant.
struct Patch {
  /// Approximate length along u; with height and density it determines the patch's share of the triangles.
  float width_m = 1.0f;
  float height_m = 1.0f;  ///< Approximate length along v.
  float density = 1.0f;   ///< Vertices per metre, relative to the other patches.
  bool closed = false;    ///< u = 0 and u = 1 meet; shading continues across the seam.
  bool flipped = false;   ///< The patch faces opposite to (d/du x d/dv).
  std::function<Surfel(float u, float v, float spacing_m)> at;
  int columns = 1;  ///< Quads along u.
  int rows = 1;     ///< Quads along v.

  [[nodiscard]] float spacing_m() const {
    return std::max(width_m / static_cast<float>(columns), height_m / static_cast<float>(rows));
  }
};

/// Sets `flipped` so that the middle of the patch faces `point` or, with `away`, faces away from it.
void turn_towards(Patch& patch, const Vec3& point, bool away = false);

/// The patches of one file.
struct Part {
  std::string file;
  std::vector<Patch> patches;

  [[nodiscard]] GeometryCounts counts() const;
};

/// Chooses columns and rows so that all patches together have at most `triangles` triangles and, from some thousands
/// on, at least 98 % of them. Errors: kInvalidArgument if even the coarsest grids have more.
Status share_triangles(std::vector<Part>& parts, std::uint64_t triangles);

/// Called after some rows with the number of triangles computed since the last call; returns false to stop the work.
using RowsDone = std::function<bool(std::uint64_t triangles)>;

/// Computes a part and writes it to `file`, vertices first. Errors: kUnavailable if `rows_done` stopped it; otherwise
/// those of `file`.
Status write_part(const Part& part, GeometryFile& file, const RowsDone& rows_done);

}  // namespace cyclorama::generator
