// SPDX-License-Identifier: Apache-2.0
/// A picture as seen from an eye beside its own: a grid over the picture, whose vertices lie at the distances given by
/// the frame's inverse depth, and are projected again for the moved eye.
///
///     source picture              target picture, the eye 0.1 m to the right
///     ┌──┬──┬──┬──┐               ┌──┬───┬─┬──┐
///     │  │  │▓▓│  │      ──►      │  │▒▒▒│▓│  │      ▓ near: moves far      ▒ torn quad: hidden before
///     └──┴──┴──┴──┘               └──┴───┴─┴──┘
///
/// A quad is torn if inverse depth jumps across it *and* it would be stretched beyond twice its size; either alone may
/// be a surface seen at a slant. The gap takes the colours of its far side, because it shows what the near surface hid.
/// Source: Mark, McMillan and Bishop, "Post-Rendering 3D Warping", I3D 1997.
///
/// Values; reentrant; no GL.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "common/geometry/projection.h"
#include "common/image/inverse_depth.h"

namespace cyclorama::display {

/// The rays of a grid's vertices. They depend only on the picture's projection, so frames of the same size share a
/// grid.
///
/// Vertices lie in the centres of squares of `cell_px` pixels, on the picture's edge, and beyond it, so that the edge's
/// colours fill areas that come into view. A panorama of a whole turn has no edge at its sides.
struct ReprojectionGrid {
  /// Preconditions: picture.validate() succeeds; cell_px > 0. Takes milliseconds for large grids.
  ReprojectionGrid(const Projection& picture, int cell_px);

  Projection picture;
  int cell_px = 1;
  bool is_whole_turn = false;
  int columns = 0;  ///< Number of vertices in a row.
  int rows = 0;     ///< Number of rows of vertices in one eye's picture.
  // For each vertex, eye by eye, row by row:
  std::vector<float> right, up, back;     ///< Unit ray in the picture's axes (R_eye_picture()).
  std::vector<float> across_px, down_px;  ///< Position in the whole picture.
};

/// Corner of a triangle in the target picture.
struct ReprojectedVertex {
  float across_px = 0.0f;  ///< Position in the target picture.
  float down_px = 0.0f;
  /// Inverse distance from the target's eye, at most 1 / kMinDepth_m. Where triangles overlap, the one with the
  /// largest value is visible, because it is the nearest.
  float inverse_m = 0.0f;
  float source_across_px = 0.0f;
  float source_down_px = 0.0f;
};

/// Result of ReprojectionMesh::move() or find_in(). Callers reuse the object, so that its memory is reused.
struct ReprojectedPicture {
  /// The grid's vertices, then additional ones: from move(), eight for each torn quad (those of its far side, then
  /// those of its near side); from find_in(), four for each quad across which the depth jumps.
  std::vector<ReprojectedVertex> vertices;
  /// For each eye, triangles of quads across which the depth jumps.
  std::array<std::vector<std::uint32_t>, 2> jumping;
  std::size_t torn = 0;  ///< Number of torn quads.
  /// Only from find_in(): for each vertex, how far the eye's move shifted it, in pixels, without the turn.
  std::vector<float> parallax_px;
};

class ReprojectionMesh {
 public:
  /// `depth` has the whole picture's proportions, at any resolution: a frame may be shown with the depth of a smaller
  /// frame from the same eye. A vertex takes the depth of the surface in its square, and of the nearest surface if
  /// there are several. Precondition: depth is not empty.
  ReprojectionMesh(std::shared_ptr<const ReprojectionGrid> grid, const InverseDepthImage& depth);

  /// Moves the eye by `eye_m` in the Eye frame of the picture: x right, y up, z back. The result is finite for every
  /// finite move: a surface that the eye would pass through stays in front of it.
  void move(const Eigen::Vector3d& eye_m, ReprojectedPicture* ret_moved) const;

  /// Finds this picture's points in another picture of the same shape. The other picture's eye is `eye_m` away from
  /// this one's (in the frame of move()), and turning it to the right by `turn_rad` gives this picture's heading. The
  /// result's targets are positions in the other picture, and may lie far outside it. A quad across which the depth
  /// jumps follows its nearest corner, and gets four vertices of its own after the grid's.
  void find_in(const Eigen::Vector3d& eye_m, double turn_rad, ReprojectedPicture* ret_found) const;

  [[nodiscard]] const ReprojectionGrid& grid() const { return *grid_; }
  [[nodiscard]] const InverseDepthImage& depth() const { return depth_; }
  /// Triangles of quads without a jump, for one eye, as indices of the grid's vertices. They are the same for every
  /// move.
  [[nodiscard]] std::span<const std::uint32_t> smooth(std::size_t eye) const { return smooth_[eye]; }
  /// Number of quads across which the depth jumps.
  [[nodiscard]] std::size_t jumps() const { return jumps_[0].size() + jumps_[1].size(); }

 private:
  void close_seam();
  void find_jumps();
  void place_vertices(bool is_inside, ReprojectedPicture* picture) const;
  void move_vertices(const Eigen::Vector3f& eye, ReprojectedPicture* ret_moved) const;
  void tear(const std::array<std::uint32_t, 4>& grid, std::vector<ReprojectedVertex>* vertices,
            std::vector<std::uint32_t>* indices) const;
  void add_jumping(std::size_t eye, ReprojectedPicture* moved) const;

  std::shared_ptr<const ReprojectionGrid> grid_;
  InverseDepthImage depth_;
  std::vector<float> inverse_m_;  // One for each vertex.
  std::array<std::vector<std::uint32_t>, 2> smooth_;
  std::array<std::vector<std::uint32_t>, 2> jumps_;  // Index of each quad's upper left vertex.
};

}  // namespace cyclorama::display
