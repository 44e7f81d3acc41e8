// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/head_upload.h"

#include <algorithm>
#include <array>
#include <limits>

#include "appliance/display/lit_rects.h"
#include "appliance/display/lit_triangles.h"

namespace cyclorama::display {
namespace {

constexpr std::size_t kCornerFloats = HeadUpload::kCornerFloats;

float clip_x(float x_px, int width) { return 2.0f * x_px / static_cast<float>(width) - 1.0f; }
float clip_y(float y_px, int height) { return 1.0f - 2.0f * y_px / static_cast<float>(height); }

std::vector<float> corners_of(const warp::WarpMesh& mesh) {
  std::vector<float> corners;
  corners.reserve(mesh.vertices.size() * kCornerFloats);
  for (const warp::WarpVertex& v : mesh.vertices) {
    corners.insert(corners.end(),
                   {clip_x(v.x_px, mesh.width_px), clip_y(v.y_px, mesh.height_px), v.azimuth_rad, v.tan_elevation});
  }
  return corners;
}

/// Returns the rectangle around all pixels that the mask does not blacken or that get a black lift; empty if there is
/// none.
PixelRect lit_part(const warp::MaskImage& mask, const warp::BlackLiftImage* black_lift) {
  int left = mask.width();
  int right = 0;
  int top = mask.height();
  int bottom = 0;
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      if (!(*mask.at(x, y) > 0.0f) && (black_lift == nullptr || !(*black_lift->at(x, y) > 0.0f))) continue;
      left = std::min(left, x);
      right = std::max(right, x + 1);
      top = std::min(top, y);
      bottom = std::max(bottom, y + 1);
    }
  }
  return {left, top, right - left, bottom - top};
}

std::vector<float> corners_of(const PixelRect& part, int width, int height) {
  std::vector<float> corners;
  for (const int corner : {0, 1, 2, 3}) {
    const int x = corner % 2 == 0 ? part.x : part.x + part.width;
    const int y = corner < 2 ? part.y : part.y + part.height;
    corners.insert(corners.end(), {clip_x(static_cast<float>(x), width), clip_y(static_cast<float>(y), height), 0, 0});
  }
  return corners;
}

/// Returns two triangles of a rectangle whose four corners begin at `first`.
std::array<std::uint32_t, 6> halves_of(std::uint32_t first) {
  return {first, first + 2, first + 1, first + 1, first + 2, first + 3};
}

/// Adds four corners for each rectangle, each with all the terms of its patch, since GL has no data per triangle.
void add_corners(const warp::WarpPatches& warp, const LitRect& rect, std::vector<float>* ret_corners) {
  const int across = warp.across();
  const auto index = static_cast<int>(rect.patch);
  const int left = index % across * warp.patch_width_px;
  const int top = index / across * warp.patch_height_px;
  const warp::WarpPatch& patch = warp.patches[rect.patch];
  for (const int corner : {0, 1, 2, 3}) {
    const int x = corner % 2 == 0 ? rect.part.x : rect.part.x + rect.part.width;
    const int y = corner < 2 ? rect.part.y : rect.part.y + rect.part.height;
    ret_corners->insert(ret_corners->end(),
                        {clip_x(static_cast<float>(x), warp.width_px), clip_y(static_cast<float>(y), warp.height_px),
                         static_cast<float>(x - left) / static_cast<float>(warp.patch_width_px),
                         static_cast<float>(y - top) / static_cast<float>(warp.patch_height_px)});
    for (const std::size_t term : {0U, 1U, 2U, 3U, 4U, 5U})
      ret_corners->insert(ret_corners->end(), {patch.across[term], patch.up[term]});
  }
}

/// Returns all pixels' values, rows from the bottom as GL counts them. `values(x, y, rows)` appends those of one pixel.
std::vector<float> upside_down(int width, int height, const auto& values) {
  std::vector<float> rows;
  for (int y = height - 1; y >= 0; --y) {
    for (int x = 0; x < width; ++x) values(x, y, &rows);
  }
  return rows;
}

YawCorrection turning_of(const PictureShape& shape) {
  if (std::holds_alternative<Perspective>(shape)) return YawCorrection::kFlat;
  if (std::holds_alternative<Fisheye>(shape)) return YawCorrection::kFisheye;
  CHECK(std::holds_alternative<Panorama>(shape));
  return YawCorrection::kShift;
}

}  // namespace

HeadUpload::HeadUpload(const HeadPlan& plan)
    : width_px(warp::width_px(plan.warp)),
      height_px(warp::height_px(plan.warp)),
      picture(plan.picture),
      packing(plan.packing),
      depth_bits(plan.depth_bits),
      colour{plan.colour.matrix, plan.colour.black, {}, {}} {
  CHECK(plan.mask.width() == width_px && plan.mask.height() == height_px);
  CHECK(!plan.colour.black_lift ||
        (plan.colour.black_lift->width() == width_px && plan.colour.black_lift->height() == height_px));
  const warp::BlackLiftImage* const black_lift = plan.colour.black_lift ? &*plan.colour.black_lift : nullptr;
  LitTriangles triangles;
  if (const warp::WarpMesh* const mesh = std::get_if<warp::WarpMesh>(&plan.warp)) {
    triangles = lit_triangles(*mesh, plan.mask, black_lift);
    corners = corners_of(*mesh);
  } else if (const warp::WarpPatches* const patches = std::get_if<warp::WarpPatches>(&plan.warp)) {
    features.warp_kind = WarpKind::kPatches;
    has_terms = true;
    const LitRects rects = lit_rects(*patches, plan.mask, black_lift);
    std::uint32_t first = 0;
    const auto add = [&](const std::vector<LitRect>& from, std::vector<std::uint32_t>* ret_indices) {
      for (const LitRect& rect : from) {
        add_corners(*patches, rect, &corners);
        for (const std::uint32_t corner : halves_of(first)) ret_indices->push_back(corner);
        first += 4;
      }
    };
    add(rects.whole, &triangles.whole);
    add(rects.masked, &triangles.masked);
  } else {
    features.warp_kind = WarpKind::kPixelMap;
    const PixelRect lit = lit_part(plan.mask, black_lift);
    if (!lit.empty()) {
      for (const std::uint32_t corner : halves_of(0)) triangles.masked.push_back(corner);
    }
    corners = corners_of(lit, width_px, height_px);
  }
  wholly_lit = triangles.whole.size();
  indices = std::move(triangles.whole);
  indices.insert(indices.end(), triangles.masked.begin(), triangles.masked.end());
  features.turning = turning_of(plan.picture);
  features.black_lift = plan.colour.black_lift.has_value();
  features.matrix = plan.colour.matrix.has_value();
  features.response = plan.colour.response.has_value();
  features.dither = plan.is_dithered;

  const warp::PixelMap* const pixel_map = std::get_if<warp::PixelMap>(&plan.warp);
  // Pixels without a position are black, and no NaN is uploaded.
  const auto weight = [&](int x, int y) { return pixel_map == nullptr || direction_at(plan.warp, x, y) ? 1.0f : 0.0f; };
  mask.channels = black_lift == nullptr ? 1 : 2;
  mask.values = upside_down(width_px, height_px, [&](int x, int y, std::vector<float>* ret_row) {
    ret_row->push_back(*plan.mask.at(x, y) * weight(x, y));
    if (black_lift != nullptr) ret_row->push_back(*black_lift->at(x, y) * weight(x, y));
  });
  if (pixel_map != nullptr) {
    map.channels = 2;
    map.values = upside_down(width_px, height_px, [&](int x, int y, std::vector<float>* ret_row) {
      const warp::PanoramaDirection direction = direction_at(plan.warp, x, y).value_or(warp::PanoramaDirection{});
      ret_row->push_back(static_cast<float>(direction.azimuth_rad));
      ret_row->push_back(static_cast<float>(direction.tan_elevation));
    });
  }
  std::size_t corner = 0;
  for (int row = 0; row <= kGridRows; ++row) {
    for (int column = 0; column <= kGridColumns; ++column) {
      constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
      const auto direction =
          direction_at(plan.warp, (width_px - 1) * column / kGridColumns, (height_px - 1) * row / kGridRows);
      grid[corner++] =
          direction ? PicturePlace{direction->azimuth_rad, direction->tan_elevation} : PicturePlace{kNone, kNone};
    }
  }
  if (plan.colour.response) {
    for (const warp::ResponseCurve& curve : *plan.colour.response) {
      CHECK(curve.is_valid());
      const warp::ResponseCurve fine = curve.resampled(kResponseSteps);
      response.insert(response.end(), fine.codes.begin(), fine.codes.end());
    }
  }
}

}  // namespace cyclorama::display
