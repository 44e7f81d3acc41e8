// SPDX-License-Identifier: Apache-2.0
#include "appliance/warp/warp_patches.h"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

namespace cyclorama::warp {
namespace {

constexpr int kTerms = 6;
// Nodes in each direction, at Chebyshev's positions: the fit is then close to the one with the smallest maximum error.
constexpr int kNodes = 5;
constexpr int kChecks = 9;  // Checked positions in each direction, from edge to edge.
// With patches of 64x48 pixels a head takes 7 % longer than with the largest (./bench.sh display-trade); smaller
// patches were not tested.
constexpr int kMinPatchPx = 48;
constexpr int kBlockPx = 16;  // Sides of patches are multiples of this, since rasterisers work in blocks.
constexpr double kAlike = 1.1;

using Terms = Eigen::Matrix<double, 1, kTerms>;

Terms terms(double s, double t) { return Terms(1.0, s, t, s * s, s * t, t * t); }

double value(const std::array<float, kTerms>& c, const Terms& of) {
  double sum = 0.0;
  for (int i = 0; i < kTerms; ++i) sum += static_cast<double>(c[static_cast<std::size_t>(i)]) * of[i];
  return sum;
}

PanoramaDirection place_on(const WarpPatch& patch, const Terms& of) {
  return {value(patch.across, of), value(patch.up, of)};
}

/// The part of a patch that is inside the picture, in pixels.
struct Extent {
  Eigen::Vector2d min;
  Eigen::Vector2d size;
};
Extent extent_of(const WarpPatches& grid, int column, int row) {
  const Eigen::Vector2d min(column * grid.patch_width_px, row * grid.patch_height_px);
  const Eigen::Vector2d whole(grid.patch_width_px, grid.patch_height_px);
  return {min, (Eigen::Vector2d(grid.width_px, grid.height_px) - min).cwiseMin(whole)};
}

/// Returns the fitted patch; empty if a node has no position.
std::optional<WarpPatch> fitted(const ProjectorMap& map, const PictureShape& picture, const WarpPatches& grid,
                                const Extent& extent) {
  Eigen::Matrix<double, kNodes * kNodes, kTerms> design;
  Eigen::Matrix<double, kNodes * kNodes, 2> positions;
  for (int node = 0; node < kNodes * kNodes; ++node) {
    const auto chebyshev = [](int i) { return 0.5 - 0.5 * std::cos(std::numbers::pi * (i + 0.5) / kNodes); };
    const Eigen::Vector2d off =
        Eigen::Vector2d(chebyshev(node % kNodes), chebyshev(node / kNodes)).cwiseProduct(extent.size);
    const auto position = map.place_of(extent.min + off, picture);
    if (!position) return std::nullopt;
    design.row(node) = terms(off.x() / grid.patch_width_px, off.y() / grid.patch_height_px);
    positions.row(node) << position->across, position->up;
  }
  const Eigen::Matrix<double, kTerms, 2> solved = design.colPivHouseholderQr().solve(positions);
  WarpPatch patch;
  for (int i = 0; i < kTerms; ++i) {
    patch.across[static_cast<std::size_t>(i)] = static_cast<float>(solved(i, 0));
    patch.up[static_cast<std::size_t>(i)] = static_cast<float>(solved(i, 1));
  }
  return patch;
}

double worst_error(const ProjectorMap& map, const PictureShape& picture, const WarpPatches& grid, const Extent& extent,
                   const WarpPatch& patch) {
  const PixelScale scale = pixel_scale(picture);
  double worst = 0.0;
  for (int check = 0; check < kChecks * kChecks; ++check) {
    const Eigen::Vector2d off =
        Eigen::Vector2d(check % kChecks, check / kChecks).cwiseProduct(extent.size) / (kChecks - 1);
    const Eigen::Vector2d pixel = extent.min + off;
    if (!map.wall_point_of(pixel)) continue;
    const auto exact = map.place_of(pixel, picture);
    if (!exact) continue;
    const PanoramaDirection fit = place_on(patch, terms(off.x() / grid.patch_width_px, off.y() / grid.patch_height_px));
    worst = std::max(worst, scale.distance_px(*exact, {fit.azimuth_rad, fit.tan_elevation}));
  }
  return worst;
}

/// Returns the fitted patches; empty if a pixel has no position.
std::optional<WarpPatches> fitted(const ProjectorMap& map, const PictureShape& picture, int patch_width_px,
                                  int patch_height_px) {
  WarpPatches grid{map.lens().width_px, map.lens().height_px, patch_width_px, patch_height_px, {}, 0.0};
  for (int row = 0; row < grid.down(); ++row) {
    for (int column = 0; column < grid.across(); ++column) {
      const Extent extent = extent_of(grid, column, row);
      const auto patch = fitted(map, picture, grid, extent);
      if (!patch) return std::nullopt;
      grid.worst_error_px = std::max(grid.worst_error_px, worst_error(map, picture, grid, extent, *patch));
      grid.patches.push_back(*patch);
    }
  }
  return grid;
}

int half_of(int side_px) { return (side_px / 2 + kBlockPx - 1) / kBlockPx * kBlockPx; }

}  // namespace

PanoramaDirection WarpPatches::at(const Eigen::Vector2d& pixel) const {
  const int column = std::clamp(static_cast<int>(pixel.x()) / patch_width_px, 0, across() - 1);
  const int row = std::clamp(static_cast<int>(pixel.y()) / patch_height_px, 0, down() - 1);
  const WarpPatch& patch = patches[static_cast<std::size_t>(row * across() + column)];
  return place_on(patch, terms(pixel.x() / patch_width_px - column, pixel.y() / patch_height_px - row));
}

Result<WarpPatches> make_warp_patches(const ProjectorMap& map, const PictureShape& picture, double tolerance_px) {
  TRY(validate(picture));
  const auto no_patches = [](std::string_view why) {
    return Error(ErrorCode::kInvalidArgument, fmt::format("no patches hold this warp: {}; use triangles", why));
  };
  if (!map.creases().empty()) return no_patches("the wall has an edge inside the projector's picture");
  const auto whole = [](int px) { return (px + kBlockPx - 1) / kBlockPx * kBlockPx; };
  auto grid = fitted(map, picture, whole(map.lens().width_px), whole(map.lens().height_px));
  while (grid && !(grid->worst_error_px <= tolerance_px)) {
    const int narrow_px = half_of(grid->patch_width_px);
    const int flat_px = half_of(grid->patch_height_px);
    auto narrower = narrow_px < kMinPatchPx ? std::nullopt : fitted(map, picture, narrow_px, grid->patch_height_px);
    auto flatter = flat_px < kMinPatchPx ? std::nullopt : fitted(map, picture, grid->patch_width_px, flat_px);
    if (!narrower && !flatter) {
      return no_patches(
          fmt::format("the smallest are off by {:.3f} px, and {} px are required", grid->worst_error_px, tolerance_px));
    }
    // Prefers the longer side if both gain alike.
    const double favour = grid->patch_width_px >= grid->patch_height_px ? kAlike : 1.0 / kAlike;
    const bool across = !flatter || (narrower && narrower->worst_error_px <= favour * flatter->worst_error_px);
    grid = across ? std::move(narrower) : std::move(flatter);
  }
  if (!grid) return no_patches("part of the projector's picture has no position");
  return *std::move(grid);
}

}  // namespace cyclorama::warp
