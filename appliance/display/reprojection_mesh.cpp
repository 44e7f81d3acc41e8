// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/reprojection_mesh.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/check.h"
#include "common/geometry/picture_place.h"

namespace cyclorama::display {
namespace {

/// Distance by which the grid extends beyond the picture's edge.
constexpr float kBeyond_px = 96.0f;
/// Inverse depth jumps across a quad if its corners differ by more than this share of the largest inverse depth.
constexpr float kJump = 0.08f;
constexpr float kMaxStretch = 2.0f;
/// Position of a point that no pixel of the other picture shows.
constexpr double kNowhere_px = -1e6;
/// Memory is reserved for one quad across which depth jumps per this many vertices; few pictures have more.
constexpr std::size_t kPerJump = 8;
constexpr auto kNearest = static_cast<float>(1.0 / kMinDepth_m);
/// Minimum distance of a vertex, as a multiple of the eye's move, so that the eye passes through no surface.
constexpr float kMinMoves = 1.25f;

/// Returns the positions of the vertices along one side: beyond the edge, on it, in the squares' centres, on the other
/// edge, and beyond that edge.
std::vector<float> places_along(int size_px, int cell_px, bool wraps) {
  const auto size = static_cast<float>(size_px);
  std::vector<float> places;
  if (!wraps) places.push_back(-kBeyond_px);
  places.push_back(0.0f);
  for (int px = 0; px < size_px; px += cell_px) {
    places.push_back(0.5f * static_cast<float>(px + std::min(px + cell_px, size_px)));
  }
  places.push_back(size);
  if (!wraps) places.push_back(size + kBeyond_px);
  return places;
}

struct Place {
  float across = 0.0f;
  float up = 0.0f;
};

/// Returns twice the arc tangent of n, for |n| <= 0.6, with an error of at most 2e-5.
float twice_atan(float n) {
  const float s = n * n;
  const float series =
      1.0f + s * (-1.0f / 3.0f + s * (0.2f + s * (-1.0f / 7.0f + s * (1.0f / 9.0f + s * (-1.0f / 11.0f + s / 13.0f)))));
  return 2.0f * n * series;
}

/// The three functions return the position of the ray (x, y, z) + (mx, my, mz) minus that of (x, y, z). They use plain
/// arithmetic, so that the compiler vectorises those of the panorama and of the perspective.
struct MovePanorama {
  static Place place(float x, float y, float z, float mx, float my, float mz) {
    const float flat = std::sqrt(x * x + z * z);
    const float per_flat = 1.0f / std::max(flat, 1e-6f);
    const float sin_a = x * per_flat;
    const float cos_a = -z * per_flat;
    const float sideways = mx * cos_a + mz * sin_a;
    const float ahead = flat + mx * sin_a - mz * cos_a;
    const float length = std::max(std::sqrt(sideways * sideways + ahead * ahead), 1e-6f);
    // tan(a / 2) = sin a / (1 + cos a).
    const float turned = twice_atan(std::clamp(sideways / std::max(length + ahead, 1e-6f), -0.6f, 0.6f));
    return {turned, (y + my) / length - y * per_flat};
  }
};
struct MovePerspective {
  static Place place(float x, float y, float z, float mx, float my, float mz) {
    const float before = 1.0f / std::max(-z, 1e-6f);
    const float after = 1.0f / std::max(-(z + mz), 1e-3f);
    return {(x + mx) * after - x * before, (y + my) * after - y * before};
  }
};
struct MoveFisheye {
  static float stretch(float x, float y, float z) {
    const float sideways = std::sqrt(x * x + y * y);
    return sideways < 1e-6f ? 1.0f : std::atan2(sideways, -z) / sideways;
  }
  static Place place(float x, float y, float z, float mx, float my, float mz) {
    const float before = stretch(x, y, z);
    const float nx = x + mx, ny = y + my, nz = z + mz;
    const float length = std::sqrt(nx * nx + ny * ny + nz * nz);
    // Near the axis, the stretch of a unit vector is 1, and that of a longer vector is 1 / length.
    const float sideways = std::sqrt(nx * nx + ny * ny);
    const float after = sideways < 1e-6f * length ? 1.0f / length : std::atan2(sideways, -nz) / sideways;
    return {nx * after - x * before, ny * after - y * before};
  }
};

template <typename Move>
void move_all(const ReprojectionGrid& grid, const std::vector<float>& inverse_m, const Eigen::Vector3f& eye,
              ReprojectedVertex* out) {
  const PixelScale scale = pixel_scale(grid.picture.shape);
  const auto px_across = static_cast<float>(scale.u_per_across);
  const auto px_up = static_cast<float>(scale.v_per_up);
  const float length = eye.norm();
  const float largest = 1.0f / std::max(kMinMoves * length, 1e-6f);
  const float x = -eye.x(), y = -eye.y(), z = -eye.z();
  for (std::size_t i = 0; i < inverse_m.size(); ++i) {
    const float near = std::min(inverse_m[i], largest);
    const float mx = x * near, my = y * near, mz = z * near;
    const Place moved = Move::place(grid.right[i], grid.up[i], grid.back[i], mx, my, mz);
    out[i].across_px = grid.across_px[i] + moved.across * px_across;
    out[i].down_px = grid.down_px[i] + moved.up * px_up;
    const float nx = grid.right[i] + mx, ny = grid.up[i] + my, nz = grid.back[i] + mz;
    out[i].inverse_m = std::min(inverse_m[i] / std::max(std::sqrt(nx * nx + ny * ny + nz * nz), 1e-6f), kNearest);
  }
}

/// Returns inverse distances, per metre, at the cells' centres. A cell holds its nearest sample, which on a surface
/// seen at a slant lies at the cell's border. The slope of the surface is taken from the flatter of the two neighbours,
/// so that it does not extend across an edge. Without this correction, floors would move too far with the eye.
Image<float, 1> at_centres(const InverseDepthImage& depth) {
  // Distance from a cell's centre to the middle of its outermost pixel, in cells.
  constexpr float kReach = 0.5f * (kDepthCellPx - 1) / kDepthCellPx;
  Image<float, 1> centres(depth.width(), depth.height());
  const auto slope = [](int before, int here, int after) {
    const int down = here - before;
    const int up = after - here;
    return (down > 0) != (up > 0) ? 0 : std::min(std::abs(down), std::abs(up));
  };
  for (int y = 0; y < depth.height(); ++y) {
    for (int x = 0; x < depth.width(); ++x) {
      const int here = *depth.at(x, y);
      int slopes = 0;
      if (x > 0 && x + 1 < depth.width()) slopes += slope(*depth.at(x - 1, y), here, *depth.at(x + 1, y));
      if (y > 0 && y + 1 < depth.height()) slopes += slope(*depth.at(x, y - 1), here, *depth.at(x, y + 1));
      const float nearest = inverse_metres(static_cast<std::uint16_t>(here));
      *centres.at(x, y) = nearest - kReach * inverse_metres(static_cast<std::uint16_t>(std::min(slopes, here)));
    }
  }
  return centres;
}

}  // namespace

ReprojectionGrid::ReprojectionGrid(const Projection& of, int cell) : picture(of), cell_px(cell) {
  CHECK(cell > 0);
  const auto* const panorama = std::get_if<Panorama>(&picture.shape);
  is_whole_turn = panorama != nullptr && cyclorama::is_whole_turn(*panorama);
  const int width = cyclorama::width_px(picture.shape);
  const int height = cyclorama::height_px(picture.shape);
  const std::vector<float> across = places_along(width, cell, is_whole_turn);
  const std::vector<float> down = places_along(height, cell, false);
  columns = static_cast<int>(across.size());
  rows = static_cast<int>(down.size());
  const Eigen::Matrix3d to_picture = R_eye_picture(picture.shape).transpose();
  for (int eye = 0; eye < picture.stacked(); ++eye) {
    const double top = eye * height;
    for (const float v : down) {
      for (const float u : across) {
        // A vertex beyond the edge has the ray of the edge.
        const PanoramaPixel inside{std::clamp<double>(u, 0.0, width), top + std::clamp<double>(v, 0.0, height - 1e-6)};
        const auto ray = picture.ray_at(inside);
        const Eigen::Vector3d direction =
            ray ? Eigen::Vector3d(to_picture * ray->direction) : -Eigen::Vector3d::UnitZ();
        right.push_back(static_cast<float>(direction.x()));
        up.push_back(static_cast<float>(direction.y()));
        back.push_back(static_cast<float>(direction.z()));
        across_px.push_back(u);
        down_px.push_back(static_cast<float>(top) + v);
      }
    }
  }
}

ReprojectionMesh::ReprojectionMesh(std::shared_ptr<const ReprojectionGrid> grid, const InverseDepthImage& depth)
    : grid_(std::move(grid)), depth_(depth) {
  CHECK(!depth.empty());
  const Image<float, 1> centres = at_centres(depth);
  const int width = cyclorama::width_px(grid_->picture.shape);
  const int height = grid_->picture.height_px();
  // The cells of depth within half a square around a vertex.
  const auto cells_around = [&](float place_px, int size_px, int cells) {
    const double per_px = static_cast<double>(cells) / size_px;
    const double half = 0.5 * grid_->cell_px;
    const int first = static_cast<int>(std::floor((place_px - half) * per_px + 0.01));
    const int last = static_cast<int>(std::ceil((place_px + half) * per_px - 0.01)) - 1;
    return std::pair(std::clamp(first, 0, cells - 1), std::clamp(std::max(first, last), 0, cells - 1));
  };
  inverse_m_.reserve(grid_->across_px.size());
  for (std::size_t i = 0; i < grid_->across_px.size(); ++i) {
    const auto [left, right] = cells_around(grid_->across_px[i], width, depth.width());
    const auto [top, bottom] = cells_around(grid_->down_px[i], height, depth.height());
    float nearest = 0.0f;
    float farthest = kNearest;
    float sum = 0.0f;
    for (int y = top; y <= bottom; ++y) {
      for (int x = left; x <= right; ++x) {
        nearest = std::max(nearest, *centres.at(x, y));
        farthest = std::min(farthest, *centres.at(x, y));
        sum += *centres.at(x, y);
      }
    }
    const bool is_one_surface = nearest - farthest <= kJump * nearest;
    inverse_m_.push_back(is_one_surface ? sum / static_cast<float>((bottom - top + 1) * (right - left + 1)) : nearest);
  }
  if (grid_->is_whole_turn) close_seam();
  find_jumps();
}

/// The first and the last column are at the same position, so both take the nearer of their depths.
void ReprojectionMesh::close_seam() {
  const auto columns = static_cast<std::size_t>(grid_->columns);
  for (std::size_t first = 0; first < inverse_m_.size(); first += columns) {
    float& last = inverse_m_[first + columns - 1];
    last = inverse_m_[first] = std::max(inverse_m_[first], last);
  }
}

void ReprojectionMesh::find_jumps() {
  const auto columns = static_cast<std::size_t>(grid_->columns);
  const auto rows = static_cast<std::size_t>(grid_->rows);
  for (std::size_t eye = 0; eye < static_cast<std::size_t>(grid_->picture.stacked()); ++eye) {
    for (std::size_t row = 0; row + 1 < rows; ++row) {
      for (std::size_t column = 0; column + 1 < columns; ++column) {
        const std::size_t corner = (eye * rows + row) * columns + column;
        const auto [far, near] = std::minmax({inverse_m_[corner], inverse_m_[corner + 1], inverse_m_[corner + columns],
                                              inverse_m_[corner + columns + 1]});
        const auto first = static_cast<std::uint32_t>(corner);
        const auto below = static_cast<std::uint32_t>(corner + columns);
        if (near - far > kJump * near) {
          jumps_[eye].push_back(first);
        } else {
          smooth_[eye].insert(smooth_[eye].end(), {first, first + 1, below, below, first + 1, below + 1});
        }
      }
    }
  }
}

void ReprojectionMesh::move(const Eigen::Vector3d& eye_m, ReprojectedPicture* ret_moved) const {
  const Eigen::Matrix3d to_picture = R_eye_picture(grid_->picture.shape).transpose();
  place_vertices(true, ret_moved);
  move_vertices((to_picture * eye_m).cast<float>(), ret_moved);
  ret_moved->torn = 0;
  for (std::size_t eye = 0; eye < jumps_.size(); ++eye) add_jumping(eye, ret_moved);
}

void ReprojectionMesh::find_in(const Eigen::Vector3d& eye_m, double turn_rad, ReprojectedPicture* ret_found) const {
  const PictureShape& shape = grid_->picture.shape;
  place_vertices(false, ret_found);
  const Eigen::Matrix3d to_picture = R_eye_picture(shape).transpose();
  move_vertices((to_picture * eye_m).cast<float>(), ret_found);
  std::vector<ReprojectedVertex>& vertices = ret_found->vertices;
  const PixelScale scale = pixel_scale(shape);
  std::vector<float>& parallax_px = ret_found->parallax_px;
  parallax_px.reserve(vertices.capacity());
  parallax_px.clear();
  for (const ReprojectedVertex& vertex : vertices) {
    parallax_px.push_back(
        std::hypot(vertex.across_px - vertex.source_across_px, vertex.down_px - vertex.source_down_px));
  }
  const std::size_t per_eye = vertices.size() / static_cast<std::size_t>(grid_->picture.stacked());
  for (std::size_t i = 0; turn_rad != 0.0 && i < vertices.size(); ++i) {
    const double top = i < per_eye ? 0 : height_px(shape);
    const auto before = turned(shape, scale.place_at({vertices[i].across_px, vertices[i].down_px - top}), turn_rad);
    const PanoramaPixel px = before ? scale.pixel_at(*before) : PanoramaPixel{kNowhere_px, kNowhere_px};
    vertices[i].across_px = static_cast<float>(px.u);
    vertices[i].down_px = static_cast<float>(px.v + top);
  }
  const auto columns = static_cast<std::uint32_t>(grid_->columns);
  for (std::size_t eye = 0; eye < jumps_.size(); ++eye) {
    std::vector<std::uint32_t>& indices = ret_found->jumping[eye];
    indices.clear();
    for (const std::uint32_t first : jumps_[eye]) {
      const std::array<std::uint32_t, 4> corners{first, first + 1, first + columns, first + columns + 1};
      const auto nearest = *std::max_element(corners.begin(), corners.end(), [&](std::uint32_t a, std::uint32_t b) {
        return inverse_m_[a] < inverse_m_[b];
      });
      const ReprojectedVertex followed = vertices[nearest];
      const auto base = static_cast<std::uint32_t>(vertices.size());
      for (const std::uint32_t corner : corners) {
        ReprojectedVertex vertex = vertices[corner];
        vertex.across_px = followed.across_px + vertex.source_across_px - followed.source_across_px;
        vertex.down_px = followed.down_px + vertex.source_down_px - followed.source_down_px;
        vertex.inverse_m = followed.inverse_m;
        vertices.push_back(vertex);
        parallax_px.push_back(parallax_px[nearest]);
      }
      indices.insert(indices.end(), {base, base + 1, base + 2, base + 2, base + 1, base + 3});
    }
  }
}

/// Sets the positions in the source: those of the grid or, with `is_inside`, at least a pixel inside the picture, for
/// filters.
void ReprojectionMesh::place_vertices(bool is_inside, ReprojectedPicture* picture) const {
  std::vector<ReprojectedVertex>& vertices = picture->vertices;
  // Room for as many torn quads as any frame has, so that later frames allocate nothing.
  const std::size_t room = std::max(jumps(), inverse_m_.size() / kPerJump);
  vertices.reserve(inverse_m_.size() + 8 * room);
  for (std::vector<std::uint32_t>& indices : picture->jumping) indices.reserve(12 * room);
  vertices.resize(inverse_m_.size());
  const auto inside = [is_inside](float px, float first, float last) {
    return is_inside ? std::clamp(px, std::min(first + 1.0f, last), std::max(last - 1.0f, first)) : px;
  };
  const auto width = static_cast<float>(cyclorama::width_px(grid_->picture.shape));
  const int height = cyclorama::height_px(grid_->picture.shape);
  const std::size_t per_eye = static_cast<std::size_t>(grid_->columns) * static_cast<std::size_t>(grid_->rows);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const auto top = static_cast<float>(i < per_eye ? 0 : height);
    vertices[i].source_across_px = inside(grid_->across_px[i], 0.0f, width);
    vertices[i].source_down_px = inside(grid_->down_px[i], top, top + static_cast<float>(height));
  }
}

void ReprojectionMesh::move_vertices(const Eigen::Vector3f& eye, ReprojectedPicture* ret_moved) const {
  std::vector<ReprojectedVertex>& vertices = ret_moved->vertices;
  if (std::holds_alternative<Perspective>(grid_->picture.shape)) {
    move_all<MovePerspective>(*grid_, inverse_m_, eye, vertices.data());
  } else if (std::holds_alternative<Fisheye>(grid_->picture.shape)) {
    move_all<MoveFisheye>(*grid_, inverse_m_, eye, vertices.data());
  } else {
    move_all<MovePanorama>(*grid_, inverse_m_, eye, vertices.data());
  }
}

void ReprojectionMesh::add_jumping(std::size_t eye, ReprojectedPicture* moved) const {
  std::vector<ReprojectedVertex>& vertices = moved->vertices;
  std::vector<std::uint32_t>& indices = moved->jumping[eye];
  indices.clear();
  const auto columns = static_cast<std::uint32_t>(grid_->columns);
  for (const std::uint32_t first : jumps_[eye]) {
    const std::array<std::uint32_t, 4> grid{first, first + 1, first + columns, first + columns + 1};
    const auto stretch = [&](std::size_t a, std::size_t b, bool across) {
      const std::vector<float>& places = across ? grid_->across_px : grid_->down_px;
      const float source = places[grid[b]] - places[grid[a]];
      const ReprojectedVertex& from = vertices[grid[a]];
      const ReprojectedVertex& to = vertices[grid[b]];
      return std::abs(across ? to.across_px - from.across_px : to.down_px - from.down_px) / source;
    };
    const float largest =
        std::max({stretch(0, 1, true), stretch(2, 3, true), stretch(0, 2, false), stretch(1, 3, false)});
    if (largest > kMaxStretch) {
      tear(grid, &vertices, &indices);
      ++moved->torn;
    } else {
      indices.insert(indices.end(), {grid[0], grid[1], grid[2], grid[2], grid[1], grid[3]});
    }
  }
}

/// Replaces a torn quad by two. The near quad ends halfway, where the near cells end, and moves with them; the far quad
/// stretches from the far corners to the near ones, with the far cells' colours alone.
void ReprojectionMesh::tear(const std::array<std::uint32_t, 4>& grid, std::vector<ReprojectedVertex>* vertices,
                            std::vector<std::uint32_t>* indices) const {
  const auto [far, near] = std::minmax_element(
      grid.begin(), grid.end(), [&](std::uint32_t a, std::uint32_t b) { return inverse_m_[a] < inverse_m_[b]; });
  const float middle = 0.5f * (inverse_m_[*far] + inverse_m_[*near]);
  const auto is_near = [&](std::uint32_t corner) { return inverse_m_[corner] > middle; };
  std::array<ReprojectedVertex, 8> corners;  // The corners of the far quad, then those of the near quad.
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const ReprojectedVertex& own = (*vertices)[grid[i]];
    // The neighbour on the other side of the jump: horizontally or vertically adjacent, or else the farthest or nearest
    // corner.
    std::uint32_t across_the_edge = is_near(grid[i]) ? *far : *near;
    for (const std::size_t other : {i ^ 2U, i ^ 1U}) {
      if (is_near(grid[other]) != is_near(grid[i])) across_the_edge = grid[other];
    }
    const ReprojectedVertex& other = (*vertices)[across_the_edge];
    ReprojectedVertex& of_far = corners[i] = own;
    ReprojectedVertex& of_near = corners[4 + i] = own;
    const float half_across = 0.5f * (other.source_across_px - own.source_across_px);
    const float half_down = 0.5f * (other.source_down_px - own.source_down_px);
    if (is_near(grid[i])) {
      // Half a pixel less, because filters also read the neighbouring pixel.
      const auto inward = [](float half) { return half + std::copysign(std::min(0.5f, std::abs(half)), half); };
      of_far.inverse_m = other.inverse_m;
      of_far.source_across_px += inward(half_across);
      of_far.source_down_px += inward(half_down);
    } else {
      of_near.inverse_m = other.inverse_m;
      of_near.across_px = other.across_px - half_across;
      of_near.down_px = other.down_px - half_down;
      of_near.source_across_px += half_across;
      of_near.source_down_px += half_down;
    }
  }
  for (std::size_t first = 0; first < corners.size(); first += 4) {
    const auto base = static_cast<std::uint32_t>(vertices->size());
    vertices->insert(vertices->end(), corners.begin() + static_cast<std::ptrdiff_t>(first),
                     corners.begin() + static_cast<std::ptrdiff_t>(first + 4));
    indices->insert(indices->end(), {base, base + 1, base + 2, base + 2, base + 1, base + 3});
  }
}

}  // namespace cyclorama::display
