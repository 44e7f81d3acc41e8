// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/mesh_topology.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

namespace cyclorama::scene {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

/// An edge of a triangle, from its lower corner to its higher one.
struct Edge {
  std::uint32_t low, high;
  std::uint32_t triangle;
  bool forward;  ///< The triangle passes it from `low` to `high`.
};

/// Sets of triangles, in each of which a triangle faces like the first one or against it.
class SidedSets {
 public:
  explicit SidedSets(std::size_t count) : parent_(count), against_(count, false), twisted_(count, false) {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }

  struct Place {
    std::uint32_t root;
    bool against;
  };
  [[nodiscard]] Place find(std::uint32_t item) {
    std::uint32_t root = item;
    bool against = false;
    for (; parent_[root] != root; root = parent_[root]) against = against != against_[root];
    for (bool left = against; parent_[item] != root && item != root;) {
      const std::uint32_t next = parent_[item];
      const bool own = against_[item];
      parent_[item] = root;
      against_[item] = left;
      left = left != own;
      item = next;
    }
    return {root, against};
  }
  void join(std::uint32_t a, std::uint32_t b, bool against) {
    const Place at = find(a);
    const Place to = find(b);
    const bool turned = (at.against != to.against) != against;
    if (at.root == to.root) {
      if (turned) twisted_[at.root] = true;
      return;
    }
    parent_[at.root] = to.root;
    against_[at.root] = turned;
    if (twisted_[at.root]) twisted_[to.root] = true;
  }
  [[nodiscard]] bool is_twisted(std::uint32_t root) const { return twisted_[root]; }

 private:
  std::vector<std::uint32_t> parent_;
  std::vector<bool> against_;  ///< Against its parent.
  std::vector<bool> twisted_;
};

Eigen::Vector3d doubled_area(const TriangleSoup& soup, const Triangle& t) {
  return (soup.places[t[1]] - soup.places[t[0]]).cross(soup.places[t[2]] - soup.places[t[0]]);
}

std::vector<Edge> sorted_edges(const TriangleSoup& soup, const std::vector<std::uint32_t>& sheet_of) {
  std::vector<Edge> edges;
  edges.reserve(3 * soup.triangles.size());
  for (std::uint32_t i = 0; i < soup.triangles.size(); ++i) {
    if (sheet_of[i] == kNoSheet) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = soup.triangles[i][k];
      const std::uint32_t to = soup.triangles[i][(k + 1) % 3];
      edges.push_back({std::min(from, to), std::max(from, to), i, from < to});
    }
  }
  std::ranges::sort(edges, [](const Edge& a, const Edge& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  return edges;
}

/// Joins the ends of single edges to chains.
std::vector<Rim> rims_of(const std::vector<Edge>& single, const std::vector<std::uint32_t>& sheet_of) {
  const auto from = [](const Edge& e) { return e.forward ? e.low : e.high; };
  const auto to = [](const Edge& e) { return e.forward ? e.high : e.low; };
  std::vector<Edge> edges = single;
  std::ranges::sort(edges, [&](const Edge& a, const Edge& b) {
    return std::tuple(from(a), to(a), a.triangle) < std::tuple(from(b), to(b), b.triangle);
  });
  std::vector<bool> is_used(edges.size(), false);
  std::vector<Rim> rims;
  for (std::size_t first = 0; first < edges.size(); ++first) {
    if (is_used[first]) continue;
    Rim rim;
    rim.sheet = sheet_of[edges[first].triangle];
    for (std::size_t at = first; at < edges.size();) {
      is_used[at] = true;
      rim.corners.push_back(from(edges[at]));
      const std::uint32_t end = to(edges[at]);
      if (end == from(edges[first])) break;
      at = static_cast<std::size_t>(std::ranges::lower_bound(edges, end, {}, from) - edges.begin());
      while (at < edges.size() && from(edges[at]) == end && is_used[at]) ++at;
      if (at >= edges.size() || from(edges[at]) != end) break;
    }
    rims.push_back(std::move(rim));
  }
  return rims;
}

}  // namespace

Topology topology_of(const TriangleSoup& soup) {
  const std::size_t count = soup.triangles.size();
  Topology topology;
  topology.sheet_of.assign(count, 0);
  topology.is_turned.assign(count, false);
  topology.has_area.assign(count, true);
  for (std::size_t i = 0; i < count; ++i) {
    const auto& [a, b, c] = soup.triangles[i];
    if (a == b || b == c || c == a) topology.sheet_of[i] = kNoSheet;
    if (!(doubled_area(soup, soup.triangles[i]).squaredNorm() > 0.0)) topology.has_area[i] = false;
  }
  const std::vector<Edge> edges = sorted_edges(soup, topology.sheet_of);
  SidedSets sets(count);
  std::vector<Edge> single;
  std::vector<std::uint32_t> crowded;  ///< Triangles with an edge of more than two triangles.
  for (std::size_t first = 0, end = 0; first < edges.size(); first = end) {
    while (end < edges.size() && edges[end].low == edges[first].low && edges[end].high == edges[first].high) ++end;
    if (end - first == 1) single.push_back(edges[first]);
    if (end - first == 2) {
      sets.join(edges[first].triangle, edges[first + 1].triangle, edges[first].forward == edges[first + 1].forward);
    }
    for (std::size_t i = first; end - first > 2 && i < end; ++i) crowded.push_back(edges[i].triangle);
  }

  std::vector<std::uint32_t> number(count, kNoSheet);
  std::vector<double> turned_area;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (topology.sheet_of[i] == kNoSheet) continue;
    const SidedSets::Place at = sets.find(i);
    if (number[at.root] == kNoSheet) {
      number[at.root] = static_cast<std::uint32_t>(topology.sheets.size());
      topology.sheets.emplace_back().twisted = sets.is_twisted(at.root);
      turned_area.push_back(0.0);
    }
    topology.sheet_of[i] = number[at.root];
    topology.is_turned[i] = at.against;
    Sheet& sheet = topology.sheets[number[at.root]];
    const Triangle& t = soup.triangles[i];
    const double area = 0.5 * doubled_area(soup, t).norm();
    sheet.area += area;
    sheet.triangles += 1;
    sheet.turned += at.against ? 1 : 0;
    if (at.against) turned_area[number[at.root]] += area;
    const double volume = soup.places[t[0]].dot(soup.places[t[1]].cross(soup.places[t[2]])) / 6.0;
    sheet.volume += at.against ? -volume : volume;
  }
  std::vector<bool> is_swapped(topology.sheets.size(), false);
  for (std::size_t s = 0; s < topology.sheets.size(); ++s) {
    Sheet& sheet = topology.sheets[s];
    if (2.0 * turned_area[s] <= sheet.area) continue;
    is_swapped[s] = true;
    sheet.turned = sheet.triangles - sheet.turned;
    sheet.volume = -sheet.volume;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t sheet = topology.sheet_of[i];
    if (sheet != kNoSheet && is_swapped[sheet]) topology.is_turned[i] = !topology.is_turned[i];
  }
  for (const Edge& edge : single) topology.sheets[topology.sheet_of[edge.triangle]].closed = false;
  for (const std::uint32_t triangle : crowded) topology.sheets[topology.sheet_of[triangle]].closed = false;
  topology.rims = rims_of(single, topology.sheet_of);
  return topology;
}

}  // namespace cyclorama::scene
