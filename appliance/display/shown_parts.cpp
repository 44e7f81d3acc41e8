// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/shown_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/geometry/guard_band.h"
#include "common/geometry/picture_place.h"

namespace cyclorama::display {
namespace {

constexpr int kSlices = 256;
constexpr int kCellPx = 16;
// One pixel for each of the two filters (chroma, then light); chroma pixels are twice as large.
constexpr double kAround_px = 3.0;
constexpr double kUnboundedTurn_rad = 0.5;
constexpr double kHardlyMore = 1.1;
// Number of pieces into which a footprint is cut where it turns along curves, and maximum number of turns.
constexpr int kStrips = 32;
constexpr int kPieces = 32;
constexpr int kMaxTurns = 64;

int cells(int px) { return (px + kCellPx - 1) / kCellPx; }

struct Box {
  double left_px = std::numeric_limits<double>::infinity();
  double right_px = -std::numeric_limits<double>::infinity();
  double top_px = std::numeric_limits<double>::infinity();
  double bottom_px = -std::numeric_limits<double>::infinity();

  void add(const PanoramaPixel& p) {
    left_px = std::min(left_px, p.u);
    right_px = std::max(right_px, p.u);
    top_px = std::min(top_px, p.v);
    bottom_px = std::max(bottom_px, p.v);
  }
  void add(const Box& other) {
    left_px = std::min(left_px, other.left_px);
    right_px = std::max(right_px, other.right_px);
    top_px = std::min(top_px, other.top_px);
    bottom_px = std::max(bottom_px, other.bottom_px);
  }
  [[nodiscard]] Box grown(double across_px, double down_px) const {
    return {left_px - across_px, right_px + across_px, top_px - down_px, bottom_px + down_px};
  }
};

/// A flag for each cell of a picture: whether it is needed.
class CellMap {
 public:
  explicit CellMap(const PictureShape& picture)
      : width_px_(width_px(picture)), height_px_(height_px(picture)), columns_(cells(width_px_)) {
    const auto* const panorama = std::get_if<Panorama>(&picture);
    wraps_ = panorama != nullptr && is_whole_turn(*panorama);
    wanted_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows()), false);
  }
  [[nodiscard]] int rows() const { return cells(height_px_); }
  /// Marks a row's cells between two positions in pixels, either of which may lie outside the picture.
  void want(int row, double left_px, double right_px) {
    const double width = width_px_;
    if (wraps_ && right_px - left_px >= width) return mark(row, 0.0, width);
    if (!wraps_) return mark(row, left_px, right_px);
    const double turns = std::floor(left_px / width) * width;
    mark(row, left_px - turns, right_px - turns);
    if (right_px - turns > width) mark(row, 0.0, right_px - turns - width);
  }
  /// Marks the cells in the rectangle; for parts beyond an edge, the nearest cells inside.
  void want(const Box& box) {
    const int first = static_cast<int>(std::clamp(box.top_px, 0.0, height_px_ - 1.0)) / kCellPx;
    const int last = static_cast<int>(std::clamp(box.bottom_px, 0.0, height_px_ - 1.0)) / kCellPx;
    for (int row = first; row <= last; ++row) want(row, box.left_px, box.right_px);
  }
  /// Returns the marked cells as rectangles; adjacent rows with the same columns form one part.
  [[nodiscard]] std::vector<PixelRect> parts() const {
    std::vector<PixelRect> parts;
    std::size_t above = 0;  // Index of the first part that ends at this row's upper edge.
    for (int row = 0; row < rows(); ++row) {
      const std::vector<PixelRect> runs = runs_of(row);
      const bool same =
          parts.size() - above == runs.size() &&
          std::equal(runs.begin(), runs.end(), parts.begin() + static_cast<std::ptrdiff_t>(above),
                     [](const PixelRect& a, const PixelRect& b) { return a.x == b.x && a.width == b.width; });
      if (!same) {
        above = parts.size();
        parts.insert(parts.end(), runs.begin(), runs.end());
        continue;
      }
      for (std::size_t i = 0; i < runs.size(); ++i) parts[above + i].height += runs[i].height;
    }
    return parts;
  }

 private:
  void mark(int row, double left_px, double right_px) {
    const int first = static_cast<int>(std::clamp(left_px, 0.0, width_px_ - 1.0)) / kCellPx;
    const int last = static_cast<int>(std::clamp(right_px, 0.0, width_px_ - 1.0)) / kCellPx;
    for (int column = first; column <= last; ++column) wanted_[index(row, column)] = true;
  }
  [[nodiscard]] std::vector<PixelRect> runs_of(int row) const {
    const int y = row * kCellPx;
    const int height = std::min(kCellPx, height_px_ - y);
    std::vector<PixelRect> runs;
    for (int column = 0; column < columns_; ++column) {
      if (!wanted_[index(row, column)]) continue;
      const int x = column * kCellPx;
      const int width = std::min(kCellPx, width_px_ - x);
      const bool goes_on = !runs.empty() && runs.back().x + runs.back().width == x;
      if (goes_on) {
        runs.back().width += width;
      } else {
        runs.push_back({x, y, width, height});
      }
    }
    return runs;
  }
  [[nodiscard]] std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }
  int width_px_;
  int height_px_;
  int columns_;
  bool wraps_ = false;
  std::vector<bool> wanted_;
};

// Rows of pixels by which a picture extends beyond the wall's, above or below: pixels move by at most that much when
// the picture is shown from another eye.
double rows_beyond(const Panorama& picture, const Panorama& wall) {
  const double rows_per_tan = picture.height_px / (picture.tan_elevation_top - picture.tan_elevation_bottom);
  return rows_per_tan * std::max(picture.tan_elevation_top - wall.tan_elevation_top,
                                 wall.tan_elevation_bottom - picture.tan_elevation_bottom);
}
double rows_beyond(const Perspective& picture, const Perspective& wall) {
  const double rows_per_tan = picture.height_px / (picture.tan_top - picture.tan_bottom);
  return rows_per_tan * std::max(picture.tan_top - wall.tan_top, wall.tan_bottom - picture.tan_bottom);
}
double rows_beyond(const Fisheye& picture, const Fisheye& wall) {
  return 0.5 * (picture.field_rad - wall.field_rad) / picture.radians_per_px();
}
template <typename A, typename B>
double rows_beyond(const A&, const B&) {
  return 0.0;
}
double margin_px(const PictureShape& picture, const PictureShape& wall) {
  const double rows = std::visit([](const auto& a, const auto& b) { return rows_beyond(a, b); }, picture, wall);
  return kAround_px + std::max(0.0, rows);
}

/// Marks the cells of a panorama, in which a turn is a shift.
void want_shifted(const HeadFootprint& head, const Panorama& picture, double turn_limit_rad, double margin,
                  CellMap* ret_cells) {
  for (int row = 0; row < ret_cells->rows(); ++row) {
    // Positions beyond the picture show its edge.
    constexpr double kEndless = std::numeric_limits<double>::infinity();
    const bool is_first = row == 0;
    const bool is_last = row + 1 == ret_cells->rows();
    const double top = is_first ? kEndless : picture.tan_elevation_at(row * kCellPx - margin);
    const double bottom = is_last ? -kEndless : picture.tan_elevation_at((row + 1) * kCellPx + margin);
    const auto span = head.across_between(bottom, top);
    if (!span) continue;
    const auto column = [&](double azimuth) { return (azimuth / picture.azimuth_span_rad + 0.5) * picture.width_px; };
    ret_cells->want(row, column(span->min - turn_limit_rad) - kAround_px,
                    column(span->max + turn_limit_rad) + kAround_px);
  }
}

/// Marks the cells of the other projections, in which every position moves along its own curve. Positions between the
/// corners of a small piece, and between one turn and the next, lie within the box around those corners, enlarged by an
/// eighth.
void want_turned(const HeadFootprint& head, const PictureShape& picture, double turn_limit_rad, double margin,
                 CellMap* ret_cells) {
  const auto all = head.up();
  if (!all) return;
  const PixelScale scale = pixel_scale(picture);
  const double moves_px = 2.0 * turn_limit_rad * std::abs(scale.u_per_across);
  const int turns = static_cast<int>(std::clamp(std::ceil(moves_px / kCellPx), 1.0, double{kMaxTurns}));
  for (int strip = 0; strip < kStrips; ++strip) {
    const double low = all->min + (all->max - all->min) * strip / kStrips;
    const double high = all->min + (all->max - all->min) * (strip + 1) / kStrips;
    const auto span = head.across_between(low, high);
    if (!span) continue;
    std::array<Box, kPieces> before;  // Boxes at the previous turn.
    for (int turn = 0; turn <= turns; ++turn) {
      std::array<Box, kPieces> now;
      for (int end = 0; end <= kPieces; ++end) {
        const double across = span->min + (span->max - span->min) * end / kPieces;
        for (const double up : {low, high}) {
          const auto position = turned(picture, {across, up}, turn_limit_rad * (2.0 * turn / turns - 1.0));
          if (!position) continue;  // The position is exactly opposite to a fisheye's axis.
          if (end < kPieces) now[static_cast<std::size_t>(end)].add(scale.pixel_at(*position));
          if (end > 0) now[static_cast<std::size_t>(end - 1)].add(scale.pixel_at(*position));
        }
      }
      for (std::size_t piece = 0; piece < kPieces; ++piece) {
        Box box = now[piece];
        if (turn > 0) box.add(before[piece]);
        ret_cells->want(
            box.grown(margin + (box.right_px - box.left_px) / 8.0, margin + (box.bottom_px - box.top_px) / 8.0));
      }
      before = now;
    }
  }
}

std::int64_t area(const ShownParts& shown) {
  std::int64_t sum = 0;
  for (const PixelRect& part : shown.parts) sum += part.area();
  return sum;
}

}  // namespace

HeadFootprint::HeadFootprint(const warp::Warp& warp, const warp::MaskImage& mask) {
  CHECK(mask.width() == width_px(warp) && mask.height() == height_px(warp));
  std::vector<PicturePlace> lit;
  double max_up = -std::numeric_limits<double>::infinity();
  min_up_ = std::numeric_limits<double>::infinity();
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      if (!(*mask.at(x, y) > 0.0f)) continue;
      const auto direction = direction_at(warp, x, y);
      if (!direction) continue;
      lit.push_back({direction->azimuth_rad, direction->tan_elevation});
      min_up_ = std::min(min_up_, direction->tan_elevation);
      max_up = std::max(max_up, direction->tan_elevation);
    }
  }
  if (lit.empty()) return;
  up_per_slice_ = std::max((max_up - min_up_) / kSlices, std::numeric_limits<double>::min());
  slices_.resize(kSlices);
  for (const PicturePlace& position : lit) {
    const double at = (position.up - min_up_) / up_per_slice_;
    std::optional<Span>& slice = slices_[static_cast<std::size_t>(std::clamp(at, 0.0, kSlices - 1.0))];
    if (!slice) slice = Span{position.across, position.across};
    slice->min = std::min(slice->min, position.across);
    slice->max = std::max(slice->max, position.across);
  }
}

std::optional<HeadFootprint::Span> HeadFootprint::up() const {
  if (slices_.empty()) return std::nullopt;
  return Span{min_up_, min_up_ + kSlices * up_per_slice_};
}

std::optional<HeadFootprint::Span> HeadFootprint::across_between(double min_up, double max_up) const {
  std::optional<Span> all;
  for (std::size_t i = 0; i < slices_.size(); ++i) {
    const double lower = min_up_ + up_per_slice_ * static_cast<double>(i);
    if (!slices_[i] || lower > max_up || lower + up_per_slice_ < min_up) continue;
    if (!all) all = slices_[i];
    all->min = std::min(all->min, slices_[i]->min);
    all->max = std::max(all->max, slices_[i]->max);
  }
  return all;
}

bool ShownParts::meets(const PixelRect& rect) const {
  return std::ranges::any_of(parts, [&](const PixelRect& part) {
    return rect.x < part.x + part.width && part.x < rect.x + rect.width && rect.y < part.y + part.height &&
           part.y < rect.y + rect.height;
  });
}

ShownParts shown_by_both_eyes(const ShownParts& of_one, int height_px) {
  ShownParts both = of_one;
  for (PixelRect part : of_one.parts) {
    part.y += height_px;
    both.parts.push_back(part);
  }
  return both;
}

ShownParts shown_parts(const std::vector<HeadFootprint>& heads, const PictureShape& picture, const PictureShape& wall,
                       bool for_every_turn) {
  const double margin = margin_px(picture, wall);
  const auto parts_within = [&](double turn_limit_rad) {
    CellMap wanted(picture);
    for (const HeadFootprint& head : heads) {
      if (const auto* const panorama = std::get_if<Panorama>(&picture)) {
        want_shifted(head, *panorama, turn_limit_rad, margin, &wanted);
      } else {
        want_turned(head, picture, turn_limit_rad, margin, &wanted);
      }
    }
    return ShownParts{turn_limit_rad, wanted.parts()};
  };
  const double turn_limit_rad = turn_reach(picture, wall);
  if (std::isfinite(turn_limit_rad)) return parts_within(turn_limit_rad);
  ShownParts some = parts_within(kUnboundedTurn_rad);
  ShownParts all = parts_within(std::numbers::pi);
  return for_every_turn || static_cast<double>(area(all)) <= kHardlyMore * static_cast<double>(area(some)) ? all : some;
}

}  // namespace cyclorama::display
