// SPDX-License-Identifier: Apache-2.0
#include "appliance/interchange/warp_net.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "appliance/interchange/fault.h"
#include "appliance/interchange/map_sampling.h"

namespace cyclorama::interchange {
namespace {

constexpr double kMaxCoordinate = 1000.0;  ///< In units of pictures, above any projector's lens shift.
constexpr int kMaxGridSide = 4096;
constexpr int kMaxRasterPx = 16384;

/// Returns twice the signed area of a triangle.
double area(const WarpNode& a, const WarpNode& b, double x, double y) {
  return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

class Raster {
 public:
  Raster(int width, int height)
      : map_(width, height, std::numeric_limits<float>::quiet_NaN()), light_(width, height, 1, 16) {}

  void draw(const WarpNode& a, const WarpNode& b, const WarpNode& c) {
    const double whole = area(a, b, c.x, c.y);
    if (!(std::abs(whole) > 0.0)) return;
    const auto [left, right] = std::minmax({a.x, b.x, c.x});
    const auto [low, high] = std::minmax({a.y, b.y, c.y});
    const int w = map_.width();
    const int h = map_.height();
    const int x0 = first_at(left * w - 0.5, w);
    const int x1 = last_at(right * w - 0.5, w);
    const int y0 = first_at((1.0 - high) * h - 0.5, h);
    const int y1 = last_at((1.0 - low) * h - 0.5, h);
    for (int j = y0; j <= y1; ++j) {
      for (int i = x0; i <= x1; ++i) {
        const double x = (i + 0.5) / w;
        const double y = 1.0 - (j + 0.5) / h;
        const double wa = area(b, c, x, y) / whole;
        const double wb = area(c, a, x, y) / whole;
        const double wc = 1.0 - wa - wb;
        constexpr double kRim = -1e-9;  // A pixel on a shared edge belongs to both triangles, so that no gap is left.
        if (wa < kRim || wb < kRim || wc < kRim) continue;
        float* const out = map_.at(i, j);
        out[0] = static_cast<float>(wa * a.u + wb * b.u + wc * c.u);
        out[1] = static_cast<float>(wa * a.v + wb * b.v + wc * c.v);
        out[2] = 0.0f;
        const double light = std::clamp(wa * a.light + wb * b.light + wc * c.light, 0.0, 1.0);
        light_.samples[static_cast<std::size_t>(j) * static_cast<std::size_t>(w) + static_cast<std::size_t>(i)] =
            static_cast<std::uint16_t>(std::lround(65535.0 * light));
        ++drawn_;
      }
    }
  }

  [[nodiscard]] bool is_empty() const { return drawn_ == 0; }
  WarpMap map_;
  MaskMap light_;

 private:
  static int first_at(double location, int count) {
    return static_cast<int>(std::clamp(std::ceil(location - 1e-6), 0.0, static_cast<double>(count)));
  }
  static int last_at(double location, int count) {
    return static_cast<int>(std::clamp(std::floor(location + 1e-6), -1.0, count - 1.0));
  }
  std::size_t drawn_ = 0;
};

}  // namespace

std::vector<WarpTriangle> WarpNet::drawn() const {
  std::vector<WarpTriangle> found = triangles;
  const auto across = static_cast<std::uint32_t>(columns);
  for (int row = 0; row + 1 < rows; ++row) {
    for (int column = 0; column + (closed ? 0 : 1) < columns; ++column) {
      const auto at = [&](int r, int c) {
        return static_cast<std::uint32_t>(r) * across + static_cast<std::uint32_t>(c % columns);
      };
      const std::uint32_t a = at(row, column), b = at(row, column + 1);
      const std::uint32_t c = at(row + 1, column + 1), d = at(row + 1, column);
      found.push_back({a, b, c});
      found.push_back({a, c, d});
    }
  }
  std::erase_if(found, [this](const WarpTriangle& t) {
    return nodes[t[0]].light < 0.0 || nodes[t[1]].light < 0.0 || nodes[t[2]].light < 0.0;
  });
  return found;
}

Status check(const WarpNet& net) {
  if (net.nodes.empty() || net.nodes.size() > kMaxWarpNodes || net.triangles.size() > kMaxWarpTriangles) {
    return fault("mesh", fmt::format("it has {} nodes and {} triangles", net.nodes.size(), net.triangles.size()),
                 fmt::format("export 1 to {} nodes and at most {} triangles", kMaxWarpNodes, kMaxWarpTriangles));
  }
  if (net.columns != 0 || net.rows != 0) {
    if (net.columns < 2 || net.rows < 2 || !net.triangles.empty() ||
        net.nodes.size() / static_cast<std::size_t>(net.rows) != static_cast<std::size_t>(net.columns) ||
        net.nodes.size() % static_cast<std::size_t>(net.rows) != 0) {
      return fault("mesh", fmt::format("{} nodes do not make {}x{} of them", net.nodes.size(), net.columns, net.rows),
                   "export a grid of at least 2x2");
    }
  } else if (net.triangles.empty()) {
    return fault("mesh", "it has no faces", "export the mesh with its faces");
  }
  for (std::size_t i = 0; i < net.nodes.size(); ++i) {
    const WarpNode& n = net.nodes[i];
    for (const double value : {n.x, n.y, n.u, n.v}) {
      if (!(std::abs(value) <= kMaxCoordinate)) {
        return fault(fmt::format("mesh node {}", i + 1), fmt::format("{} is no position in a picture", value),
                     "export x, y, u and v in parts of the picture");
      }
    }
    if (!(n.light <= 1.0 && n.light >= -kMaxCoordinate)) {
      return fault(fmt::format("mesh node {}", i + 1), fmt::format("its intensity is {}", n.light),
                   "give 0 to 1, or a negative one where nothing is drawn");
    }
  }
  for (std::size_t i = 0; i < net.triangles.size(); ++i) {
    for (const std::uint32_t node : net.triangles[i]) {
      if (node >= net.nodes.size()) {
        return fault(fmt::format("mesh face {}", i + 1), fmt::format("there is no node {}", node + 1),
                     "export the mesh again");
      }
    }
  }
  return Done{};
}

Result<WarpRegion> region_from(const WarpNet& net, const std::string& id, int width_px, int height_px) {
  TRY(check(net));
  if (width_px < 1 || height_px < 1 || width_px > kMaxRasterPx || height_px > kMaxRasterPx) {
    return Error(ErrorCode::kInvalidArgument, fmt::format("a projector has no {}x{} pixels", width_px, height_px));
  }
  Raster raster(width_px, height_px);
  for (const WarpTriangle& t : net.drawn()) raster.draw(net.nodes[t[0]], net.nodes[t[1]], net.nodes[t[2]]);
  if (raster.is_empty()) {
    return fault("mesh", "it covers no pixel of the projector", "look at its coordinates and at the aspect ratio");
  }
  WarpRegion region;
  region.id = id;
  region.width_px = width_px;
  region.height_px = height_px;
  region.map = std::move(raster.map_);
  const bool is_dimmed =
      std::any_of(net.nodes.begin(), net.nodes.end(), [](const WarpNode& n) { return n.light != 1.0; });
  if (is_dimmed) region.alpha = std::move(raster.light_);
  return region;
}

Result<WarpNet> net_from(const WarpRegion& region, int columns, int rows) {
  if (!region.map || region.map->empty()) {
    return Error(ErrorCode::kInvalidArgument, fmt::format("region '{}' has no map to make a mesh of", region.id));
  }
  if (columns < 2 || rows < 2 || columns > kMaxGridSide || rows > kMaxGridSide ||
      static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows) > kMaxWarpNodes) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("a mesh of {}x{} nodes; give 2 to {} each way", columns, rows, kMaxGridSide));
  }
  WarpNet net;
  net.columns = columns;
  net.rows = rows;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      WarpNode node{static_cast<double>(i) / (columns - 1), static_cast<double>(j) / (rows - 1), 0.0, 0.0, -1.0};
      if (const auto sample = sample_map(*region.map, node.x, 1.0 - node.y)) {
        node.u = sample->x();
        node.v = sample->y();
        node.light = region.alpha ? sample_light(*region.alpha, node.x, 1.0 - node.y) : 1.0;
      }
      net.nodes.push_back(node);
    }
  }
  return net;
}

}  // namespace cyclorama::interchange
