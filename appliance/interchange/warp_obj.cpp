// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <utility>

#include "appliance/interchange/mesh_files.h"
#include "appliance/interchange/text_lines.h"
#include "common/geometry/obj_text.h"
#include "common/geometry/polygon.h"

namespace cyclorama::interchange {
namespace {

using Pair = std::array<double, 2>;
using Corner = std::pair<std::uint32_t, std::uint32_t>;  ///< Vertex and texture vertex, counted from 0.

constexpr std::size_t kMaxCorners = 64;  ///< Maximum number of corners of a face.
constexpr std::array<std::string_view, 9> kPassedOver{"vn", "vp", "o", "g", "s", "l", "p", "usemtl", "mtllib"};

class ObjReader {
 public:
  explicit ObjReader(std::string_view text) : statements_(text) {}

  Result<WarpNet> read() {
    std::string_view keyword;
    std::string_view rest;
    while (statements_.next(&keyword, &rest)) {
      if (keyword == "v") {
        TRY(read_vertex(rest));
      } else if (keyword == "vt") {
        TRY_ASSIGN(const Pair texture, pair_of(fields_of(rest), "vt"));
        textures_.push_back(texture);
      } else if (keyword == "f") {
        TRY(read_face(fields_of(rest)));
      } else if (std::find(kPassedOver.begin(), kPassedOver.end(), keyword) == kPassedOver.end()) {
        return fault(location(), fmt::format("'{}' is no part of a warp", printable(keyword)),
                     "export vertices, texture vertices and faces alone");
      }
      if (vertices_.size() > kMaxWarpNodes || textures_.size() > kMaxWarpNodes || faces_.size() > kMaxWarpTriangles) {
        return fault(location(), "the mesh is too large",
                     fmt::format("export at most {} nodes and {} triangles", kMaxWarpNodes, kMaxWarpTriangles));
      }
    }
    if (vertices_.empty()) return fault("end", "there is no vertex", "give a mesh as Wavefront OBJ");
    WarpNet net = joined();
    TRY(check(net));
    return net;
  }

 private:
  [[nodiscard]] std::string location() const { return fmt::format("line {}", statements_.line()); }

  Status read_vertex(std::string_view rest) {
    const auto numbers = fields_of(rest);
    TRY_ASSIGN(const Pair at, pair_of(numbers, "v"));
    if (numbers.size() == 3) {
      TRY_ASSIGN(const double z, number_of(numbers[2], location()));
      if (z != 0.0) {
        return fault(location(), "the mesh is not flat",
                     "export x and y over the projector's picture; points in space go into MPCDI a3");
      }
    }
    vertices_.push_back(at);
    return Done{};
  }

  Result<Pair> pair_of(const std::vector<std::string_view>& numbers, std::string_view keyword) const {
    if (numbers.size() < 2 || numbers.size() > 3) {
      return fault(location(), fmt::format("{} numbers after '{}'", numbers.size(), keyword), "give two or three");
    }
    Pair pair{};
    for (std::size_t i = 0; i < pair.size(); ++i) {
      TRY_ASSIGN(pair[i], number_of(numbers[i], location()));
    }
    return pair;
  }

  Status read_face(const std::vector<std::string_view>& words) {
    if (words.size() < 3 || words.size() > kMaxCorners) {
      return fault(location(), fmt::format("a face of {} corners", words.size()),
                   fmt::format("give 3 to {}", kMaxCorners));
    }
    std::vector<Corner> corners;
    std::vector<Eigen::Vector3d> positions;
    for (const std::string_view word : words) {
      const ObjCornerWords parts = obj_corner(word);
      if (!parts.beyond.empty()) return fault(location(), "a corner has more than three indices", "export it again");
      TRY_ASSIGN(const std::uint32_t vertex, index_of(parts.vertex, vertices_.size()));
      TRY_ASSIGN(const std::uint32_t texture,
                 index_of(parts.texture.empty() ? parts.vertex : parts.texture, textures_.size()));
      corners.emplace_back(vertex, texture);
      positions.emplace_back(vertices_[vertex][0], vertices_[vertex][1], 0.0);
    }
    std::vector<WarpTriangle> cut;
    triangulate(positions, &cut);
    for (const WarpTriangle& t : cut) faces_.push_back({corners[t[0]], corners[t[1]], corners[t[2]]});
    return Done{};
  }

  Result<std::uint32_t> index_of(std::string_view word, std::size_t count) const {
    if (const auto index = obj_index(word, count, count)) return *index;
    return fault(location(), fmt::format("a face names '{}' of {} so far", printable(word), count),
                 "write vertices, each with its texture vertex, before their faces");
  }

  [[nodiscard]] WarpNode node_of(const Corner& corner) const {
    const Pair& at = vertices_[corner.first];
    const Pair& from = textures_[corner.second];
    return {0.5 * (at[0] + 1.0), 0.5 * (at[1] + 1.0), from[0], from[1], 1.0};
  }

  /// Returns the net. If each vertex has one texture vertex, vertices become nodes; otherwise each pair of the two
  /// does.
  [[nodiscard]] WarpNet joined() const {
    WarpNet net;
    bool is_paired = vertices_.size() == textures_.size();
    for (const auto& face : faces_) {
      for (const Corner& corner : face) is_paired = is_paired && corner.first == corner.second;
    }
    if (is_paired) {
      for (std::uint32_t i = 0; i < vertices_.size(); ++i) net.nodes.push_back(node_of({i, i}));
    }
    std::map<Corner, std::uint32_t> seen;
    for (const auto& face : faces_) {
      WarpTriangle triangle{};
      for (std::size_t i = 0; i < 3; ++i) {
        if (is_paired) {
          triangle[i] = face[i].first;
          continue;
        }
        const auto [at, is_new] = seen.try_emplace(face[i], static_cast<std::uint32_t>(net.nodes.size()));
        if (is_new) net.nodes.push_back(node_of(face[i]));
        triangle[i] = at->second;
      }
      net.triangles.push_back(triangle);
    }
    return net;
  }

  ObjStatements statements_;
  std::vector<Pair> vertices_;
  std::vector<Pair> textures_;
  std::vector<std::array<Corner, 3>> faces_;
};

}  // namespace

Result<WarpNet> parse_warp_obj(std::string_view text) {
  std::string storage;
  return ObjReader(to_utf8(std::as_bytes(std::span(text)), &storage)).read();
}

Result<std::string> print_warp_obj(const WarpNet& net) {
  TRY(check(net));
  std::string text = "# A warp: v over the projector's picture (-1 to 1), vt in the source picture (0 to 1).\n";
  for (const WarpNode& node : net.nodes) {
    text += fmt::format("v {} {} 0\n", decimals(2.0 * node.x - 1.0), decimals(2.0 * node.y - 1.0));
  }
  for (const WarpNode& node : net.nodes) text += fmt::format("vt {} {}\n", decimals(node.u), decimals(node.v));
  for (const WarpTriangle& t : net.drawn()) {
    text += fmt::format("f {0}/{0} {1}/{1} {2}/{2}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  }
  return text;
}

}  // namespace cyclorama::interchange
