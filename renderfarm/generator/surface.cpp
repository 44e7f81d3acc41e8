// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/generator/surface.h"

#include <fmt/format.h>

#include <limits>

namespace cyclorama::generator {
namespace {

/// Minimum along either side of a patch, with which an arch or a head is still recognisable.
constexpr int kMinQuads = 4;

std::uint64_t triangles_of(const Patch& patch) {
  return 2u * static_cast<std::uint64_t>(patch.columns) * static_cast<std::uint64_t>(patch.rows);
}

std::uint64_t vertices_of(const Patch& patch) {
  return (static_cast<std::uint64_t>(patch.columns) + 1u) * (static_cast<std::uint64_t>(patch.rows) + 1u);
}

int quads(double length_m, double density, double scale) {
  return std::max(kMinQuads, static_cast<int>(std::lround(length_m * density * scale)));
}

std::uint64_t set_resolution(std::vector<Part>& parts, double scale) {
  std::uint64_t sum = 0;
  for (Part& part : parts) {
    for (Patch& patch : part.patches) {
      const auto density = static_cast<double>(patch.density);
      patch.columns = quads(static_cast<double>(patch.width_m), density, scale);
      patch.rows = quads(static_cast<double>(patch.height_m), density, scale);
      sum += triangles_of(patch);
    }
  }
  return sum;
}

/// Adds the triangles that rounding left over to the largest patch, as rows; one row matters least there.
void spend_rest(std::vector<Part>& parts, std::uint64_t rest) {
  Patch* largest = nullptr;
  for (Part& part : parts) {
    for (Patch& patch : part.patches) {
      if (largest == nullptr || triangles_of(patch) > triangles_of(*largest)) largest = &patch;
    }
  }
  if (largest == nullptr) return;
  largest->rows += static_cast<int>(rest / (2u * static_cast<std::uint64_t>(largest->columns)));
}

/// Three rows of a patch, as required for the normals of the middle row.
class RowWindow {
 public:
  explicit RowWindow(const Patch& patch) : patch_(patch), spacing_(patch.spacing_m()) {
    for (auto& row : rows_) row.resize(static_cast<std::size_t>(patch.columns) + 1u);
    compute(0, rows_[1]);
    compute(1, rows_[2]);
  }

  /// Computes the vertices of `row`, which must be 0 in the first call and increase by 1 with each call.
  void next(int row, std::vector<Vertex>& ret_vertices) {
    const bool first = row == 0;
    const bool last = row == patch_.rows;
    ret_vertices.resize(rows_[1].size());
    const std::vector<Surfel>& above = first ? rows_[1] : rows_[0];
    const std::vector<Surfel>& below = last ? rows_[1] : rows_[2];
    for (std::size_t i = 0; i < rows_[1].size(); ++i) ret_vertices[i] = vertex(i, above, below);
    if (last) return;
    std::swap(rows_[0], rows_[1]);
    std::swap(rows_[1], rows_[2]);
    if (row + 2 <= patch_.rows) compute(row + 2, rows_[2]);
  }

 private:
  void compute(int row, std::vector<Surfel>& ret_row) const {
    const float v = static_cast<float>(row) / static_cast<float>(patch_.rows);
    for (int i = 0; i <= patch_.columns; ++i) {
      // The last column of a closed patch is the first one exactly, so that the seam has no crack.
      const int column = patch_.closed && i == patch_.columns ? 0 : i;
      const float u = static_cast<float>(column) / static_cast<float>(patch_.columns);
      ret_row[static_cast<std::size_t>(i)] = patch_.at(u, v, spacing_);
    }
  }

  [[nodiscard]] Vertex vertex(std::size_t i, const std::vector<Surfel>& above, const std::vector<Surfel>& below) const {
    const std::vector<Surfel>& row = rows_[1];
    const std::size_t last = row.size() - 1;
    const std::size_t left = i > 0 ? i - 1 : (patch_.closed ? last - 1 : 0);
    const std::size_t right = i < last ? i + 1 : (patch_.closed ? 1 : last);
    Vec3 normal = (row[right].position - row[left].position).cross(below[i].position - above[i].position);
    const float length = normal.norm();
    // A grid that folds to a point has no normal there; any unit vector is as good.
    normal =
        length > std::numeric_limits<float>::min() ? Vec3(normal / (patch_.flipped ? -length : length)) : Vec3::UnitY();
    Vertex vertex;
    for (int axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<std::size_t>(axis);
      vertex.position[k] = row[i].position[axis];
      vertex.normal[k] = normal[axis];
      vertex.colour[k] = static_cast<std::uint8_t>(unit_clamp(row[i].colour[axis]) * 255.0f + 0.5f);
    }
    return vertex;
  }

  const Patch& patch_;
  float spacing_;
  std::vector<Surfel> rows_[3];
};

Status stopped() { return Error(ErrorCode::kUnavailable, "stopped before the grotto was complete"); }

Status write_vertices(const Patch& patch, GeometryFile& file, const RowsDone& rows_done) {
  RowWindow window(patch);
  std::vector<Vertex> vertices;
  for (int row = 0; row <= patch.rows; ++row) {
    window.next(row, vertices);
    TRY(file.add_vertices(vertices));
    if (!rows_done(row == 0 ? 0u : 2u * static_cast<std::uint64_t>(patch.columns))) return stopped();
  }
  return Done{};
}

Status write_triangles(const Patch& patch, std::uint64_t first_vertex, GeometryFile& file, const RowsDone& rows_done) {
  std::vector<Triangle> triangles(2u * static_cast<std::size_t>(patch.columns));
  const auto stride = static_cast<std::uint32_t>(patch.columns) + 1u;
  for (int row = 0; row < patch.rows; ++row) {
    const std::uint32_t start = static_cast<std::uint32_t>(first_vertex) + static_cast<std::uint32_t>(row) * stride;
    for (std::uint32_t i = 0; i + 1u < stride; ++i) {
      const std::uint32_t a = start + i;
      const std::uint32_t b = a + 1u;
      const std::uint32_t c = a + stride;
      const std::uint32_t d = c + 1u;
      // Diagonals alternate, so that painted edges look alike in both directions.
      const bool rising = ((i + static_cast<std::uint32_t>(row)) & 1u) != 0u;
      Triangle first = rising ? Triangle{a, b, c} : Triangle{a, b, d};
      Triangle second = rising ? Triangle{b, d, c} : Triangle{a, d, c};
      if (patch.flipped) {
        std::swap(first[1], first[2]);
        std::swap(second[1], second[2]);
      }
      triangles[2u * i] = first;
      triangles[2u * i + 1u] = second;
    }
    TRY(file.add_triangles(triangles));
    if (!rows_done(0)) return stopped();
  }
  return Done{};
}

}  // namespace

void turn_towards(Patch& patch, const Vec3& point, bool away) {
  constexpr float kStep = 0.02f;
  const Vec3 middle = patch.at(0.5f, 0.5f, 1.0f).position;
  const Vec3 du = patch.at(0.5f + kStep, 0.5f, 1.0f).position - patch.at(0.5f - kStep, 0.5f, 1.0f).position;
  const Vec3 dv = patch.at(0.5f, 0.5f + kStep, 1.0f).position - patch.at(0.5f, 0.5f - kStep, 1.0f).position;
  patch.flipped = (du.cross(dv).dot(point - middle) < 0.0f) != away;
}

GeometryCounts Part::counts() const {
  GeometryCounts counts;
  for (const Patch& patch : patches) {
    counts.vertices += vertices_of(patch);
    counts.triangles += triangles_of(patch);
  }
  return counts;
}

Status share_triangles(std::vector<Part>& parts, std::uint64_t triangles) {
  const std::uint64_t fewest = set_resolution(parts, 0.0);
  if (fewest > triangles) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("a grotto needs at least {} triangles; {} were requested", fewest, triangles));
  }
  double low = 0.0;
  double high = 1.0;
  while (set_resolution(parts, high) <= triangles) high *= 2.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (set_resolution(parts, middle) <= triangles ? low : high) = middle;
  }
  spend_rest(parts, triangles - set_resolution(parts, low));
  return Done{};
}

Status write_part(const Part& part, GeometryFile& file, const RowsDone& rows_done) {
  for (const Patch& patch : part.patches) TRY(write_vertices(patch, file, rows_done));
  std::uint64_t first_vertex = 0;
  for (const Patch& patch : part.patches) {
    TRY(write_triangles(patch, first_vertex, file, rows_done));
    first_vertex += vertices_of(patch);
  }
  return file.finish();
}

}  // namespace cyclorama::generator
