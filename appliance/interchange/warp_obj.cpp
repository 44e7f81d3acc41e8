// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <map>
#include <utility>

#include "appliance/interchange/mesh_files.h"
#include "appliance/interchange/text_lines.h"

namespace cyclorama {
namespace {

using Pair = std::array<double, 2>;
using Corner = std::pair<std::uint32_t, std::uint32_t>;  ///< Vertex and texture vertex, counted from 0.

constexpr std::size_t kMostCorners = 64;  ///< Of one face.
constexpr std::array<std::string_view, 9> kPassedOver{"vn", "vp", "o", "g", "s", "l", "p", "usemtl", "mtllib"};

class ObjReader {
 public:
  explicit ObjReader(std::string_view text) : lines_(text) {}

  Result<WarpNet> read() {
    while (const auto line = lines_.next()) {
      if (line->front() == '#') continue;
      const auto fields = fields_of(*line);
      if (fields[0] == "v") {
        TRY(read_vertex(fields));
      } else if (fields[0] == "vt") {
        TRY_ASSIGN(const Pair texture, pair_of(fields, 4));
        textures_.push_back(texture);
      } else if (fields[0] == "f") {
        TRY(read_face(fields));
      } else if (std::find(kPassedOver.begin(), kPassedOver.end(), fields[0]) == kPassedOver.end()) {
        return fault(lines_.place(), fmt::format("'{}' is no part of a warp", printable(fields[0])),
                     "export vertices, texture vertices and faces alone");
      }
      if (vertices_.size() > kMostWarpNodes || textures_.size() > kMostWarpNodes ||
          faces_.size() > kMostWarpTriangles) {
        return fault(lines_.place(), "the mesh is too large",
                     fmt::format("export at most {} nodes and {} triangles", kMostWarpNodes, kMostWarpTriangles));
      }
    }
    if (vertices_.empty()) return fault("end", "there is no vertex", "give a mesh as Wavefront OBJ");
    WarpNet net = joined();
    TRY(check(net));
    return net;
  }

 private:
  Status read_vertex(const std::vector<std::string_view>& fields) {
    TRY_ASSIGN(const Pair place, pair_of(fields, 4));
    if (fields.size() == 4) {
      TRY_ASSIGN(const double z, number_of(fields[3], lines_.place()));
      if (z != 0.0) {
        return fault(lines_.place(), "the mesh is not flat",
                     "export x and y over the projector's picture; points in space go into MPCDI a3");
      }
    }
    vertices_.push_back(place);
    return Done{};
  }

  Result<Pair> pair_of(const std::vector<std::string_view>& fields, std::size_t most) const {
    if (fields.size() < 3 || fields.size() > most) {
      return fault(lines_.place(), fmt::format("{} numbers after '{}'", fields.size() - 1, fields[0]),
                   "give two or three");
    }
    Pair pair{};
    for (std::size_t i = 0; i < 2; ++i) {
      TRY_ASSIGN(pair[i], number_of(fields[i + 1], lines_.place()));
    }
    return pair;
  }

  Status read_face(const std::vector<std::string_view>& fields) {
    if (fields.size() < 4 || fields.size() > kMostCorners + 1) {
      return fault(lines_.place(), fmt::format("a face of {} corners", fields.size() - 1),
                   fmt::format("give 3 to {}", kMostCorners));
    }
    std::vector<Corner> corners;
    for (std::size_t i = 1; i < fields.size(); ++i) {
      const auto parts = fields_of(fields[i], '/');
      if (parts.size() > 3) return fault(lines_.place(), "a corner has more than three indices", "export it again");
      TRY_ASSIGN(const std::uint32_t vertex, index_of(parts[0], vertices_.size()));
      const bool has_texture = parts.size() > 1 && !parts[1].empty();
      TRY_ASSIGN(const std::uint32_t texture, index_of(has_texture ? parts[1] : parts[0], textures_.size()));
      corners.emplace_back(vertex, texture);
    }
    for (std::size_t i = 2; i < corners.size(); ++i) faces_.push_back({corners[0], corners[i - 1], corners[i]});
    return Done{};
  }

  /// From 1, or from the end when negative.
  Result<std::uint32_t> index_of(std::string_view field, std::size_t count) const {
    const auto index = parse_integer(field);
    const auto most = static_cast<long long>(count);
    if (!index || *index == 0 || *index > most || *index < -most) {
      return fault(lines_.place(), fmt::format("a face names '{}' of {} so far", printable(field), count),
                   "write vertices, each with its texture vertex, before their faces");
    }
    return static_cast<std::uint32_t>(*index > 0 ? *index - 1 : most + *index);
  }

  [[nodiscard]] WarpNode node_of(const Corner& corner) const {
    const Pair& at = vertices_[corner.first];
    const Pair& from = textures_[corner.second];
    return {0.5 * (at[0] + 1.0), 0.5 * (at[1] + 1.0), from[0], from[1], 1.0};
  }

  /// Vertices that always have their own texture vertex stay the nodes that they are; else each pair becomes a node.
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

  TextLines lines_;
  std::vector<Pair> vertices_;
  std::vector<Pair> textures_;
  std::vector<std::array<Corner, 3>> faces_;
};

}  // namespace

Result<WarpNet> parse_warp_obj(std::string_view text) { return ObjReader(text).read(); }

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

}  // namespace cyclorama
