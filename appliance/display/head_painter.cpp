// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/head_painter.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <numbers>
#include <string>

#include "appliance/display/lit_rects.h"
#include "appliance/display/lit_triangles.h"
#include "common/geometry/picture_place.h"

namespace cyclorama {
namespace {

// As many that the nearest is within a 30th of a code value on an sRGB curve; ./bench.sh display-trade has the others.
constexpr int kResponseSteps = 4096;
constexpr std::size_t kCornerFloats = 4;
constexpr std::size_t kTermFloats = 12;

GLsizeiptr byte_count(const auto& values) { return static_cast<GLsizeiptr>(values.size() * sizeof(values[0])); }

float clip_x(float x_px, int width) { return 2.0f * x_px / static_cast<float>(width) - 1.0f; }
float clip_y(float y_px, int height) { return 1.0f - 2.0f * y_px / static_cast<float>(height); }

std::vector<float> corners_of(const WarpMesh& mesh) {
  std::vector<float> corners;
  corners.reserve(mesh.vertices.size() * kCornerFloats);
  for (const WarpVertex& v : mesh.vertices) {
    corners.insert(corners.end(),
                   {clip_x(v.x_px, mesh.width_px), clip_y(v.y_px, mesh.height_px), v.azimuth_rad, v.tan_elevation});
  }
  return corners;
}

/// The rectangle of all pixels that the mask does not blacken or that get a lift; empty when there is none.
PixelRect lit_part(const MaskImage& mask, const LiftImage* lift) {
  int left = mask.width();
  int right = 0;
  int top = mask.height();
  int bottom = 0;
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      if (!(*mask.at(x, y) > 0.0f) && (lift == nullptr || !(*lift->at(x, y) > 0.0f))) continue;
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

/// Two triangles of a rectangle whose four corners begin at `first`.
std::array<std::uint32_t, 6> halves_of(std::uint32_t first) {
  return {first, first + 2, first + 1, first + 1, first + 2, first + 3};
}

/// Four corners for each rectangle, each with all the terms of its patch: GL keeps nothing per triangle.
void add_corners(const WarpPatches& warp, const LitRect& rect, std::vector<float>* ret_corners) {
  const int across = warp.across();
  const auto index = static_cast<int>(rect.patch);
  const int left = index % across * warp.patch_width_px;
  const int top = index / across * warp.patch_height_px;
  const WarpPatch& patch = warp.patches[rect.patch];
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

/// Whether places beyond the picture, or the other side of a whole turn, need more than the sampler's own clamping.
bool needs_edges(const TurnedPicture& turned) {
  const PanoramaTexture& picture = *turned.picture;
  const auto* const panorama = std::get_if<Panorama>(&picture.shape());
  return (panorama != nullptr && is_whole_turn(*panorama)) ||
         picture.texture_width() != width_px(picture.shape()) + 2 * PanoramaTexture::kFirstColumn ||
         picture.texture_height() != height_px(picture.shape());
}

/// A texture of one value per pixel of the head, read at pixel centres.
void upload_nearest(const Gl& gl, const GlTexture& texture, GLint kept_as, GLenum channels, int width, int height,
                    const std::vector<float>& values) {
  gl.BindTexture(GL_TEXTURE_2D, texture.id());
  for (const int filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    gl.TexParameteri(GL_TEXTURE_2D, static_cast<GLenum>(filter), GL_NEAREST);
  for (const int wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    gl.TexParameteri(GL_TEXTURE_2D, static_cast<GLenum>(wrap), GL_CLAMP_TO_EDGE);
  gl.TexImage2D(GL_TEXTURE_2D, 0, kept_as, width, height, 0, channels, GL_FLOAT, values.data());
}

/// `values(x, y)` puts a pixel's values at the end; GL counts rows from the bottom.
std::vector<float> upside_down(int width, int height, const auto& values) {
  std::vector<float> rows;
  for (int y = height - 1; y >= 0; --y) {
    for (int x = 0; x < width; ++x) values(x, y, &rows);
  }
  return rows;
}

std::vector<std::uint32_t> together(const LitTriangles& triangles) {
  std::vector<std::uint32_t> all = triangles.whole;
  all.insert(all.end(), triangles.masked.begin(), triangles.masked.end());
  return all;
}

Turning turning_of(const PictureShape& shape) {
  if (std::holds_alternative<Perspective>(shape)) return Turning::kFlat;
  if (std::holds_alternative<Fisheye>(shape)) return Turning::kFisheye;
  CHECK(std::holds_alternative<Panorama>(shape));
  return Turning::kShift;
}

/// HeadProgram::Picture::turned: what turned() does with a place's direction in the picture's axes; for a perspective
/// with what comes before and after.
Eigen::Matrix3d turning(const PictureShape& shape, double turn_rad, const Eigen::Vector2d& per_place,
                        const Eigen::Vector2d& at_origin) {
  const Eigen::Matrix3d R = R_eye_picture(shape);
  const Eigen::Matrix3d turn =
      R.transpose() * Eigen::AngleAxisd(-turn_rad, Eigen::Vector3d::UnitY()).toRotationMatrix() * R;
  if (std::holds_alternative<Fisheye>(shape)) return turn;
  Eigen::Matrix3d to_texture;  // Of a direction (x, y, z): x / -z and y / -z are its place.
  to_texture << per_place.x(), 0.0, -at_origin.x(), 0.0, per_place.y(), -at_origin.y(), 0.0, 0.0, -1.0;
  return to_texture * turn * Eigen::Vector3d(1.0, 1.0, -1.0).asDiagonal();
}

}  // namespace

Texels texels_for(const Gl& gl, const std::vector<HeadPlan>& plans) {
  const std::string renderer = gl.renderer();
  const bool is_software =
      std::ranges::any_of(std::array{"llvmpipe", "softpipe", "SwiftShader"},
                          [&](const char* name) { return renderer.find(name) != std::string::npos; });
  const bool is_plain = std::ranges::none_of(plans, [](const HeadPlan& plan) {
    return plan.depth_bits > 8 || plan.colour.matrix || plan.colour.lift || plan.colour.response;
  });
  if (!is_software || !is_plain) return Texels::kHalves;
  HeadFeatures features;
  features.texels = Texels::kPacked;
  return HeadProgram::make(gl, features) ? Texels::kPacked : Texels::kHalves;  // Not with OpenGL ES 3.0.
}

HeadPainter::HeadPainter(const Gl& gl, const HeadPlan& plan, Texels texels)
    : gl_(&gl),
      width_px_(width_px(plan.warp)),
      height_px_(height_px(plan.warp)),
      picture_(plan.picture),
      packing_(plan.packing),
      colour_{plan.colour.matrix, plan.colour.black, {}, {}},
      mesh_(gl),
      vertices_(gl),
      indices_(gl),
      mask_(gl),
      map_(gl),
      response_(gl),
      texels_(texels) {
  set_depth(plan.depth_bits);
}

void HeadPainter::set_depth(int depth_bits) {
  CHECK(depth_bits >= 1 && depth_bits <= 16);
  code_step_ = 1.0f / static_cast<float>((1 << depth_bits) - 1);
}

Result<HeadPainter> HeadPainter::make(const Gl& gl, HeadPrograms* programs, const HeadPlan& plan, Texels texels) {
  CHECK(plan.mask.width() == width_px(plan.warp) && plan.mask.height() == height_px(plan.warp));
  CHECK(!plan.colour.lift ||
        (plan.colour.lift->width() == plan.mask.width() && plan.colour.lift->height() == plan.mask.height()));
  HeadPainter painter(gl, plan, texels);
  painter.upload_textures(plan);
  const LiftImage* const lift = plan.colour.lift ? &*plan.colour.lift : nullptr;
  HeadFeatures features;
  LitTriangles triangles;
  if (const WarpMesh* const mesh = std::get_if<WarpMesh>(&plan.warp)) {
    triangles = lit_triangles(*mesh, plan.mask, lift);
    painter.upload_triangles(corners_of(*mesh), together(triangles));
  } else if (const WarpPatches* const patches = std::get_if<WarpPatches>(&plan.warp)) {
    features.places = Places::kPatches;
    const LitRects rects = lit_rects(*patches, plan.mask, lift);
    std::vector<float> corners;
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
    painter.upload_triangles(corners, together(triangles), true);
  } else {
    features.places = Places::kPixelMap;
    const PixelRect lit = lit_part(plan.mask, lift);
    if (!lit.empty()) {
      for (const std::uint32_t corner : halves_of(0)) triangles.masked.push_back(corner);
    }
    painter.upload_triangles(corners_of(lit, plan.mask.width(), plan.mask.height()), triangles.masked);
  }
  features.turning = turning_of(plan.picture);
  features.texels = texels;
  features.lift = plan.colour.lift.has_value();
  features.matrix = plan.colour.matrix.has_value();
  features.response = plan.colour.response.has_value();
  features.dither = plan.is_dithered;
  const auto add = [&](Part* part, std::size_t first, std::size_t count, bool masked) -> Status {
    if (count == 0) return Done{};
    features.mask = masked || features.lift;
    for (const std::size_t edges : {0U, 1U}) {
      for (const std::size_t fade : {0U, 1U}) {
        features.edges = edges != 0;
        features.fade = fade != 0;
        TRY_ASSIGN(part->programs[edges][fade], programs->get(features));
      }
    }
    part->first = static_cast<GLsizei>(first);
    part->count = static_cast<GLsizei>(count);
    return Done{};
  };
  TRY(add(&painter.parts_[0], 0, triangles.whole.size(), false));
  TRY(add(&painter.parts_[1], triangles.whole.size(), triangles.masked.size(), true));
  TRY(gl.check("uploading a warp, a mask and a response"));
  return painter;
}

void HeadPainter::upload_triangles(const std::vector<float>& corners, const std::vector<std::uint32_t>& indices,
                                   bool has_terms) {
  gl_->BindVertexArray(mesh_.id());
  gl_->BindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  gl_->BufferData(GL_ARRAY_BUFFER, byte_count(corners), corners.data(), GL_STATIC_DRAW);
  gl_->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.id());
  gl_->BufferData(GL_ELEMENT_ARRAY_BUFFER, byte_count(indices), indices.data(), GL_STATIC_DRAW);
  const std::size_t corner_floats = has_terms ? kCornerFloats + kTermFloats : kCornerFloats;
  const auto attribute = [&](GLuint index, GLint floats, std::size_t from) {
    gl_->EnableVertexAttribArray(index);
    // GL's own convention: an offset into the bound buffer, passed as a pointer.
    gl_->VertexAttribPointer(index, floats, GL_FLOAT, GL_FALSE, static_cast<GLsizei>(corner_floats * sizeof(float)),
                             reinterpret_cast<const void*>(from * sizeof(float)));
  };
  attribute(HeadProgram::kPlace, 2, 0);
  attribute(HeadProgram::kDirection, 2, 2);
  if (!has_terms) return;
  for (const GLuint third : {0U, 1U, 2U}) attribute(HeadProgram::kTerms + third, 4, kCornerFloats + 4 * third);
}

void HeadPainter::upload_textures(const HeadPlan& plan) {
  gl_->ActiveTexture(GL_TEXTURE0);
  gl_->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  const PixelMap* const map = std::get_if<PixelMap>(&plan.warp);
  // What lies nowhere is black, and no NaN comes to the card.
  const auto weight = [&](int x, int y) { return map == nullptr || direction_at(plan.warp, x, y) ? 1.0f : 0.0f; };
  if (plan.colour.lift) {
    upload_nearest(*gl_, mask_, GL_RG16F, GL_RG, width_px_, height_px_,
                   upside_down(width_px_, height_px_, [&](int x, int y, std::vector<float>* ret_row) {
                     ret_row->push_back(*plan.mask.at(x, y) * weight(x, y));
                     ret_row->push_back(*plan.colour.lift->at(x, y) * weight(x, y));
                   }));
  } else {
    upload_nearest(*gl_, mask_, GL_R16F, GL_RED, width_px_, height_px_,
                   upside_down(width_px_, height_px_, [&](int x, int y, std::vector<float>* ret_row) {
                     ret_row->push_back(*plan.mask.at(x, y) * weight(x, y));
                   }));
  }
  if (map != nullptr) {
    upload_nearest(*gl_, map_, GL_RG32F, GL_RG, width_px_, height_px_,
                   upside_down(width_px_, height_px_, [&](int x, int y, std::vector<float>* ret_row) {
                     const PanoramaDirection direction = direction_at(plan.warp, x, y).value_or(PanoramaDirection{});
                     ret_row->push_back(static_cast<float>(direction.azimuth_rad));
                     ret_row->push_back(static_cast<float>(direction.tan_elevation));
                   }));
  }
  if (plan.packing) {  // The second eye's pixels begin where the first one's end.
    for (const GlTexture* const texture : {&mask_, &map_}) {
      gl_->BindTexture(GL_TEXTURE_2D, texture->id());
      gl_->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_REPEAT);
      gl_->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_REPEAT);
    }
  }
  if (plan.colour.response) {
    std::vector<float> codes;
    for (const ResponseCurve& curve : *plan.colour.response) {
      CHECK(curve.is_valid());
      const ResponseCurve fine = curve.resampled(kResponseSteps);
      codes.insert(codes.end(), fine.codes.begin(), fine.codes.end());
    }
    upload_nearest(*gl_, response_, GL_R32F, GL_RED, kResponseSteps, 3, codes);
  }
}

void HeadPainter::use(const HeadProgram& program, const TurnedPicture& shown, const TurnedPicture* other, double fade,
                      Eye eye) const {
  gl_->UseProgram(program.id());
  const auto picture = [&](const HeadProgram::Picture& uniforms, const TurnedPicture& turned, GLenum unit) {
    const PictureShape& shape = turned.picture->shape();
    CHECK(has_same_places(shape, picture_));
    const PixelScale scale = pixel_scale(shape);
    const auto* const panorama = std::get_if<Panorama>(&shape);
    const bool wraps = panorama != nullptr && is_whole_turn(*panorama);
    const double shift_px = panorama != nullptr ? turned.yaw_shift_rad * scale.u_per_across : 0.0;
    const double turn_px = 2.0 * std::numbers::pi * scale.u_per_across;
    CHECK(turned.picture->texels() == texels_);
    gl_->Uniform2f(uniforms.per_texel, 1.0f / static_cast<float>(turned.picture->texture_width()),
                   1.0f / static_cast<float>(turned.picture->texture_height()));
    // Of what shaders count places in: the texture's size, or its pixels from the first one's centre on.
    const bool counts_pixels = texels_ == Texels::kPacked;
    const double width = counts_pixels ? 1.0 : turned.picture->texture_width();
    const double height = counts_pixels ? 1.0 : turned.picture->texture_height();
    const double zero = counts_pixels ? 0.5 : 0.0;
    constexpr double kFirst = PanoramaTexture::kFirstColumn;
    // The right eye's picture lies below the left eye's.
    const double first_row = eye == Eye::kRight && turned.picture->stacked() == 2 ? height_px(shape) : 0;
    // Into the texture: across and up times these, and more by those.
    Eigen::Vector2d per_place(scale.u_per_across / width, scale.v_per_up / height);
    Eigen::Vector2d at_origin((scale.u_offset + shift_px + kFirst - zero) / width,
                              (scale.v_offset + first_row - zero) / height);
    if (wraps) {
      per_place.x() = scale.u_per_across / turn_px;
      at_origin.x() = (scale.u_offset + shift_px) / turn_px;
      gl_->Uniform3f(uniforms.turn, 1.0f, static_cast<float>(turn_px / width),
                     static_cast<float>((kFirst - zero) / width));
    } else {
      gl_->Uniform3f(uniforms.turn, 0.0f, 1.0f, 0.0f);
    }
    const auto set = [&](GLint uniform, double x, double y, double z, double w) {
      gl_->Uniform4f(uniform, static_cast<float>(x), static_cast<float>(y), static_cast<float>(z),
                     static_cast<float>(w));
    };
    set(uniforms.to_texture, per_place.x(), per_place.y(), at_origin.x(), at_origin.y());
    if (panorama == nullptr) {
      const Eigen::Matrix3f matrix = turning(shape, turned.yaw_shift_rad, per_place, at_origin).cast<float>();
      gl_->UniformMatrix3fv(uniforms.turned, 1, GL_FALSE, matrix.data());  // Column by column, as GL's.
    }
    const double beyond = wraps ? 0.5 : -0.5;  // A whole turn's outer columns are the other side's.
    set(uniforms.edges, (kFirst - beyond - zero) / width, (first_row + 0.5 - zero) / height,
        (kFirst + width_px(shape) + beyond - zero) / width, (first_row + height_px(shape) - 0.5 - zero) / height);
    gl_->ActiveTexture(GL_TEXTURE0 + unit);
    gl_->BindTexture(GL_TEXTURE_2D, turned.picture->id());
  };
  picture(program.picture, shown, HeadProgram::kPicture);
  if (other != nullptr) picture(program.other, *other, HeadProgram::kOther);
  gl_->Uniform1f(program.fade, static_cast<float>(fade));
  gl_->Uniform2f(program.per_px, 1.0f / static_cast<float>(width_px_), 1.0f / static_cast<float>(height_px_));
  gl_->Uniform2f(program.response, (kResponseSteps - 1.0f) / kResponseSteps, 0.5f / kResponseSteps);
  gl_->Uniform1f(program.step, code_step_);
  const Eigen::Vector3f black = colour_.black.cast<float>();
  gl_->Uniform3f(program.black, black.x(), black.y(), black.z());
  if (colour_.matrix) {
    const Eigen::Matrix3f matrix = colour_.matrix->cast<float>();
    gl_->UniformMatrix3fv(program.matrix, 1, GL_FALSE, matrix.data());
  }
}

void HeadPainter::draw_for(Eye eye, const TurnedPicture& shown, const TurnedPicture* other, double fade,
                           bool edges) const {
  for (const Part& part : parts_) {
    if (part.count == 0) continue;
    use(*part.programs[edges ? 1 : 0][other == nullptr ? 0 : 1], shown, other, fade, eye);
    gl_->DrawElements(GL_TRIANGLES, part.count, GL_UNSIGNED_INT,
                      reinterpret_cast<const void*>(static_cast<std::size_t>(part.first) * sizeof(std::uint32_t)));
  }
}

void HeadPainter::draw(const TurnedPicture& shown, const TurnedPicture* other, double fade, bool edges, Eye now) const {
  gl_->ClearColor(0.0f, 0.0f, 0.0f, 1.0f);
  gl_->Clear(GL_COLOR_BUFFER_BIT);
  const auto bind = [&](GLenum unit, const GlTexture& texture) {
    gl_->ActiveTexture(GL_TEXTURE0 + unit);
    gl_->BindTexture(GL_TEXTURE_2D, texture.id());
  };
  bind(HeadProgram::kMask, mask_);
  bind(HeadProgram::kMap, map_);
  bind(HeadProgram::kResponse, response_);
  gl_->BindVertexArray(mesh_.id());
  if (!packing_ || takes_turns()) return draw_for(packing_ ? now : Eye::kLeft, shown, other, fade, edges);
  const bool is_beside = packing_ == StereoPacking::kSideBySide;
  const int head_width = is_beside ? 2 * width_px_ : width_px_;
  const int head_height = is_beside ? height_px_ : 2 * height_px_;
  for (const Eye eye : {Eye::kLeft, Eye::kRight}) {
    const HeadPart part = part_of_eye(*packing_, eye, head_width, head_height);
    gl_->Viewport(part.x_px, head_height - part.y_px - part.height_px, part.width_px, part.height_px);
    draw_for(eye, shown, other, fade, edges);
  }
}

void HeadPainter::draw(const TurnedPicture& shown, Eye now) const {
  draw(shown, nullptr, 0.0, needs_edges(shown), now);
}

void HeadPainter::draw(const TurnedPicture& shown, const TurnedPicture& other, double fade, Eye now) const {
  draw(shown, &other, fade, needs_edges(shown) || needs_edges(other), now);
}

void HeadPainter::warm_up(const TurnedPicture& shown, const TurnedPicture& other) const {
  for (const bool edges : {false, true}) {
    draw(shown, nullptr, 0.0, edges, Eye::kLeft);
    draw(shown, &other, 1.0, edges, Eye::kLeft);
  }
}

}  // namespace cyclorama
