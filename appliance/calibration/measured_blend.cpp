// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibration/measured_blend.h"

#include <algorithm>
#include <cmath>

#include "appliance/calibration/map_grid.h"
#include "common/geometry/picture_place.h"

namespace cyclorama::calibration {
namespace {

// Columns of a table that covers the picture; weights hardly vary within a hundred of them.
constexpr int kTableAcross = 2048;
using Table = Image<float, 1>;  // Values of inwardness() for the projector's pixel at each position of the picture.

/// Same as inwardness() in blend_mask.cpp: 1 in the middle of the picture, 0 at its edges.
double inwardness(const MeasuredMap& map, const Eigen::Vector2d& pixel) {
  const double w = map.width_px;
  const double h = map.height_px;
  const double inward = 16.0 * pixel.x() * (w - pixel.x()) * pixel.y() * (h - pixel.y()) / (w * w * h * h);
  return inward * inward;
}

/// Converts directions to positions in a picture. In a panorama of a whole turn, columns repeat.
struct PicturePositions {
  PictureShape shape;
  PixelScale scale;
  double turn_px = 0.0;  // 0: not a whole turn.

  explicit PicturePositions(const PictureShape& picture)
      : shape(with_pixels(picture, kTableAcross,
                          std::max(1, static_cast<int>(std::lround(static_cast<double>(kTableAcross) *
                                                                   height_px(picture) / width_px(picture)))))),
        scale(pixel_scale(shape)) {
    const auto* const panorama = std::get_if<Panorama>(&shape);
    if (panorama != nullptr && is_whole_turn(*panorama)) turn_px = width_px(shape);
  }
  [[nodiscard]] std::optional<Eigen::Vector2d> at(const Eigen::Vector3d& direction) const {
    const auto position = direction.allFinite() ? place_of(shape, direction) : std::nullopt;
    if (!position) return std::nullopt;
    const PanoramaPixel pixel = scale.pixel_at(*position);
    return Eigen::Vector2d(pixel.u, pixel.v);
  }
  /// Returns the column nearest to `other` that has the same position as `u`.
  [[nodiscard]] double near(double u, double other) const {
    return turn_px > 0.0 ? u - turn_px * std::round((u - other) / turn_px) : u;
  }
  [[nodiscard]] int column(int x) const {
    const int width = width_px(shape);
    return turn_px > 0.0 ? ((x % width) + width) % width : x;
  }
};

struct Corner {
  Eigen::Vector2d at;     // Position in the table.
  Eigen::Vector2d pixel;  // Pixel of the projector.
};

double side_of(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& p) {
  return (b.x() - a.x()) * (p.y() - a.y()) - (b.y() - a.y()) * (p.x() - a.x());
}

void draw(const MeasuredMap& map, const PicturePositions& positions, const std::array<Corner, 3>& c, Table* table) {
  const double area = side_of(c[0].at, c[1].at, c[2].at);
  if (!(std::abs(area) > 1e-12)) return;
  const auto [left, right] = std::minmax({c[0].at.x(), c[1].at.x(), c[2].at.x()});
  const auto [top, bottom] = std::minmax({c[0].at.y(), c[1].at.y(), c[2].at.y()});
  if (right - left > kTableAcross / 2.0) return;
  const int first_y = std::max(0, static_cast<int>(std::ceil(top - 0.5)));
  const int last_y = std::min(table->height() - 1, static_cast<int>(std::floor(bottom - 0.5)));
  for (int y = first_y; y <= last_y; ++y) {
    for (int x = static_cast<int>(std::ceil(left - 0.5)); x <= static_cast<int>(std::floor(right - 0.5)); ++x) {
      const int column = positions.column(x);
      if (column < 0 || column >= table->width()) continue;
      const Eigen::Vector2d p(x + 0.5, y + 0.5);
      const std::array<double, 3> of{side_of(c[1].at, c[2].at, p) / area, side_of(c[2].at, c[0].at, p) / area,
                                     side_of(c[0].at, c[1].at, p) / area};
      if (!(std::ranges::min(of) >= -1e-9)) continue;
      const Eigen::Vector2d pixel = of[0] * c[0].pixel + of[1] * c[1].pixel + of[2] * c[2].pixel;
      *table->at(column, y) = static_cast<float>(inwardness(map, pixel));
    }
  }
}

Table table_of(const MeasuredMap& map, const PicturePositions& positions) {
  Table table(width_px(positions.shape), height_px(positions.shape));
  const MapGrid grid{map.width_px, map.height_px, map.cells_x, map.cells_y};
  const auto corner = [&](int x, int y) -> std::optional<Corner> {
    const auto at = positions.at(map.directions[static_cast<std::size_t>(grid.node(x, y))]);
    if (!at) return std::nullopt;
    return Corner{*at, {x * grid.cell_width(), y * grid.cell_height()}};
  };
  for (int y = 0; y < map.cells_y; ++y) {
    for (int x = 0; x < map.cells_x; ++x) {
      for (const auto& [a, b] :
           {std::pair{corner(x + 1, y), corner(x + 1, y + 1)}, std::pair{corner(x, y + 1), corner(x + 1, y + 1)}}) {
        const auto first = corner(x, y);
        if (!first || !a || !b) continue;
        std::array<Corner, 3> corners{*first, *a, *b};
        for (Corner& c : corners) c.at.x() = positions.near(c.at.x(), first->at.x());
        draw(map, positions, corners, &table);
      }
    }
  }
  return table;
}

/// Interpolates bilinearly; 0 outside the picture.
double value_at(const Table& table, const PicturePositions& positions, const Eigen::Vector2d& at) {
  const double u = at.x() - 0.5;
  const double v = at.y() - 0.5;
  const int x = static_cast<int>(std::floor(u));
  const int y = static_cast<int>(std::floor(v));
  double sum = 0.0;
  for (const int dy : {0, 1}) {
    for (const int dx : {0, 1}) {
      const int column = positions.column(x + dx);
      const int row = std::clamp(y + dy, 0, table.height() - 1);
      if (column < 0 || column >= table.width()) continue;
      sum += static_cast<double>(*table.at(column, row)) * (dx == 1 ? u - x : 1.0 - (u - x)) *
             (dy == 1 ? v - y : 1.0 - (v - y));
    }
  }
  return sum;
}

warp::MaskImage mask_of(const MeasuredMap& map, const std::vector<Table>& others, const PicturePositions& positions) {
  warp::MaskImage mask(map.width_px, map.height_px);
  for (int y = 0; y < map.height_px; ++y) {
    for (int x = 0; x < map.width_px; ++x) {
      const Eigen::Vector2d pixel(x + 0.5, y + 0.5);
      const auto direction = map.direction_at(pixel);
      const auto at = direction ? positions.at(*direction) : std::nullopt;
      if (!at) continue;
      const double own = inwardness(map, pixel);
      double sum = own;
      for (const Table& other : others) sum += value_at(other, positions, *at);
      *mask.at(x, y) = static_cast<float>(own / sum);
    }
  }
  return mask;
}

}  // namespace

std::vector<warp::MaskImage> measured_blend_masks(std::span<const MeasuredMap* const> maps,
                                                  const PictureShape& picture) {
  const PicturePositions positions(picture);
  std::vector<Table> tables;
  for (const MeasuredMap* const map : maps) tables.push_back(map == nullptr ? Table() : table_of(*map, positions));
  std::vector<warp::MaskImage> masks;
  for (std::size_t i = 0; i < maps.size(); ++i) {
    std::vector<Table> others;
    for (std::size_t j = 0; j < maps.size(); ++j) {
      if (j != i && maps[j] != nullptr) others.push_back(tables[j]);
    }
    masks.push_back(maps[i] == nullptr ? warp::MaskImage() : mask_of(*maps[i], others, positions));
  }
  return masks;
}

}  // namespace cyclorama::calibration
