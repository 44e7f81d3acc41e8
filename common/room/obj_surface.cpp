// SPDX-License-Identifier: Apache-2.0
#include "common/room/obj_surface.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <string>
#include <utility>

#include "common/base/text.h"
#include "common/geometry/obj_text.h"
#include "common/geometry/polygon.h"

namespace cyclorama {
namespace {

constexpr double kMaxDistanceM = 100.0;
constexpr std::size_t kMaxTriangles = 2'000'000;
constexpr double kMinArea_m2 = 1e-12;  // A square micrometre; smaller triangles have no reliable direction.

/// Statements that do not affect the surface's shape.
constexpr std::string_view kPassedOver[] = {"vn", "g", "o", "s", "usemtl", "mtllib", "usemap", "maplib", "p", "l"};

/// Reads one file.
class Reader {
 public:
  explicit Reader(std::string_view text) : statements_(text) {}

  Result<ObjSurface> read() {
    std::string_view keyword;
    std::string_view rest;
    while (statements_.next(&keyword, &rest)) {
      if (keyword == "v") {
        TRY(add_position(rest));
      } else if (keyword == "vt") {
        TRY(add_texture_place(rest));
      } else if (keyword == "f") {
        TRY(add_face(rest));
      } else if (std::ranges::find(kPassedOver, keyword) == std::end(kPassedOver)) {
        return refuse(
            fmt::format("'{}' is not understood in a wall; export the surface as polygons", printable(keyword, 40)));
      }
    }
    if (surface_.triangles.empty()) return Error(ErrorCode::kBadData, "has no faces; export the wall's surface");
    return std::move(surface_);
  }

 private:
  [[nodiscard]] Error refuse(const std::string& what) const {
    return Error(ErrorCode::kBadData, fmt::format("line {}: {}", statements_.line(), what));
  }

  /// Parses at least `min` numbers, each of which is a whole word and finite.
  Result<std::vector<double>> numbers(std::string_view rest, std::size_t min) const {
    std::vector<double> values;
    for (std::string_view word = next_word(&rest); !word.empty(); word = next_word(&rest)) {
      bool whole = false;
      const auto value = number_in(word, &whole);
      if (!value || !whole || !std::isfinite(*value)) {
        return refuse(fmt::format("'{}' is not a number", printable(word, 40)));
      }
      values.push_back(*value);
    }
    if (values.size() < min) return refuse(fmt::format("has {} numbers; {} are needed", values.size(), min));
    return values;
  }

  Status add_position(std::string_view rest) {
    TRY_ASSIGN(const std::vector<double> n, numbers(rest, 3));
    const Eigen::Vector3d place(n[0], n[1], n[2]);
    if (!(place.cwiseAbs().maxCoeff() <= kMaxDistanceM)) {
      return refuse(fmt::format("({}, {}, {}) is farther than {} m from the room's origin; the file is in metres", n[0],
                                n[1], n[2], kMaxDistanceM));
    }
    // Programs write a corner once for each of its normals; the surface stores each position once.
    const auto known = ids_.emplace(std::array{n[0], n[1], n[2]}, surface_.positions.size());
    if (known.second) surface_.positions.push_back(place);
    positions_.push_back(static_cast<std::uint32_t>(known.first->second));
    return Done{};
  }

  Status add_texture_place(std::string_view rest) {
    TRY(numbers(rest, 2));
    ++texture_places_;
    return Done{};
  }

  Result<std::uint32_t> index(std::string_view word, std::string_view what, std::size_t count) const {
    if (const auto found = obj_index(word, count, count)) return *found;
    return refuse(fmt::format("'{}' is none of the {} {} above", printable(word, 40), count, what));
  }

  Status add_face(std::string_view rest) {
    std::vector<std::uint32_t> corners;
    std::vector<Eigen::Vector3d> places;
    for (std::string_view word = next_word(&rest); !word.empty(); word = next_word(&rest)) {
      const ObjCornerWords words = obj_corner(word);
      TRY_ASSIGN(const std::uint32_t position, index(words.vertex, "positions", positions_.size()));
      if (!words.texture.empty()) TRY(index(words.texture, "texture coordinates", texture_places_));
      corners.push_back(positions_[position]);
      places.push_back(surface_.positions[corners.back()]);
    }
    if (corners.size() < 3) return refuse(fmt::format("a face has {} corners; 3 are needed", corners.size()));
    std::vector<std::array<std::uint32_t, 3>> cut;
    triangulate(places, &cut);
    for (const auto& t : cut) TRY(add_triangle({corners[t[0]], corners[t[1]], corners[t[2]]}));
    return Done{};
  }

  Status add_triangle(const std::array<std::uint32_t, 3>& t) {
    const Eigen::Vector3d& a = surface_.positions[t[0]];
    const double area = 0.5 * (surface_.positions[t[1]] - a).cross(surface_.positions[t[2]] - a).norm();
    if (!(area > kMinArea_m2)) return refuse("a face has no area; merge corners that lie in one place");
    for (std::size_t i = 0; i < 3; ++i) {
      const auto edge = std::pair(t[i], t[(i + 1) % 3]);
      const auto known = lines_.emplace(edge, statements_.line());
      if (!known.second) {
        return refuse(
            fmt::format("this face runs against the one in line {}, or covers it; make all faces run "
                        "counter-clockwise as the visitor sees them",
                        known.first->second));
      }
    }
    if (surface_.triangles.size() >= kMaxTriangles) {
      return refuse(fmt::format("more than {} triangles; reduce the mesh", kMaxTriangles));
    }
    surface_.triangles.push_back(t);
    return Done{};
  }

  ObjStatements statements_;
  ObjSurface surface_;
  std::vector<std::uint32_t> positions_;  ///< Indices into surface_.positions, in the file's order.
  std::map<std::array<double, 3>, std::size_t> ids_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> lines_;  ///< Line in the file of each directed edge.
  std::size_t texture_places_ = 0;
};

}  // namespace

Result<ObjSurface> read_obj_surface(std::string_view text) {
  std::string storage;
  return Reader(to_utf8(std::as_bytes(std::span(text)), &storage)).read();
}

std::vector<ObjEdge> edges_of(const ObjSurface& surface) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> directed;
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    const auto& t = surface.triangles[i];
    for (std::size_t k = 0; k < 3; ++k) directed.emplace(std::pair(t[k], t[(k + 1) % 3]), i);
  }
  std::vector<ObjEdge> edges;
  for (const auto& [ends, triangle] : directed) {
    const auto back = directed.find({ends.second, ends.first});
    if (back == directed.end()) {
      edges.push_back({ends.first, ends.second, triangle, std::nullopt});
    } else if (ends.first < ends.second) {
      edges.push_back({ends.first, ends.second, triangle, back->second});
    }
  }
  return edges;
}

}  // namespace cyclorama
