// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/head_painter.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "common/geometry/picture_place.h"

namespace cyclorama::display {
namespace {

constexpr int kResponseSteps = HeadUpload::kResponseSteps;

GLsizeiptr byte_count(const auto& values) { return static_cast<GLsizeiptr>(values.size() * sizeof(values[0])); }

/// True if positions beyond the picture, or across a whole turn's seam, need more than the sampler's clamping.
bool needs_edges(const TurnedPicture& turned) {
  const PanoramaTexture& picture = *turned.picture;
  const auto* const panorama = std::get_if<Panorama>(&picture.shape());
  return (panorama != nullptr && is_whole_turn(*panorama)) ||
         picture.texture_width() != width_px(picture.shape()) + 2 * PanoramaTexture::kFirstColumn ||
         picture.texture_height() != height_px(picture.shape());
}

/// Uploads a texture of one or two values per pixel of the head, read at pixel centres.
void upload_nearest(const output::Gl& gl, const output::GlTexture& texture, GLint kept_as, GLenum channels, int width,
                    int height, const std::vector<float>& values) {
  gl.BindTexture(GL_TEXTURE_2D, texture.id());
  for (const int filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    gl.TexParameteri(GL_TEXTURE_2D, static_cast<GLenum>(filter), GL_NEAREST);
  for (const int wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    gl.TexParameteri(GL_TEXTURE_2D, static_cast<GLenum>(wrap), GL_CLAMP_TO_EDGE);
  gl.TexImage2D(GL_TEXTURE_2D, 0, kept_as, width, height, 0, channels, GL_FLOAT, values.data());
}

/// Matrix of HeadProgram::Picture::turned: the effect of turned() on a position's direction in the picture's axes; for
/// a perspective, including the conversions before and after.
Eigen::Matrix3d turning(const PictureShape& shape, double turn_rad, const Eigen::Vector2d& per_position,
                        const Eigen::Vector2d& at_origin) {
  const Eigen::Matrix3d R = R_eye_picture(shape);
  const Eigen::Matrix3d turn =
      R.transpose() * Eigen::AngleAxisd(-turn_rad, Eigen::Vector3d::UnitY()).toRotationMatrix() * R;
  if (std::holds_alternative<Fisheye>(shape)) return turn;
  Eigen::Matrix3d to_texture;  // Maps a direction (x, y, z) with the position (x / -z, y / -z).
  to_texture << per_position.x(), 0.0, -at_origin.x(), 0.0, per_position.y(), -at_origin.y(), 0.0, 0.0, -1.0;
  return to_texture * turn * Eigen::Vector3d(1.0, 1.0, -1.0).asDiagonal();
}

/// Scale and offset from a position (across, up) to the texture of a turned panorama, before it wraps; in the units of
/// the shader, which are the texture's size, or pixels from the centre of its first pixel. In other pictures the turn is
/// not included.
struct InTexture {
  Eigen::Vector2d per_position;
  Eigen::Vector2d at_origin;
  double width = 1.0;  ///< Pixels of a unit.
  double height = 1.0;
  double zero = 0.0;     ///< Pixel at 0.
  double first_row = 0;  ///< First row of the eye's picture: the right eye's lies below the left eye's.
  bool wraps = false;    ///< A whole turn, of which across counts the turns.
  double turn_px = 0.0;
};
InTexture in_texture(const TurnedPicture& turned, Eye eye) {
  const PictureShape& shape = turned.picture->shape();
  const PixelScale scale = pixel_scale(shape);
  const auto* const panorama = std::get_if<Panorama>(&shape);
  const double shift_px = panorama != nullptr ? turned.yaw_shift_rad * scale.u_per_across : 0.0;
  const bool counts_pixels = turned.picture->texels() == Texels::kPacked;
  InTexture in;
  in.width = counts_pixels ? 1.0 : turned.picture->texture_width();
  in.height = counts_pixels ? 1.0 : turned.picture->texture_height();
  in.zero = counts_pixels ? 0.5 : 0.0;
  in.first_row = eye == Eye::kRight && turned.picture->stacked() == 2 ? height_px(shape) : 0;
  in.wraps = panorama != nullptr && is_whole_turn(*panorama);
  in.turn_px = 2.0 * std::numbers::pi * scale.u_per_across;
  in.per_position = {scale.u_per_across / in.width, scale.v_per_up / in.height};
  in.at_origin = {(scale.u_offset + shift_px + PanoramaTexture::kFirstColumn - in.zero) / in.width,
                  (scale.v_offset + in.first_row - in.zero) / in.height};
  if (in.wraps) {
    in.per_position.x() = scale.u_per_across / in.turn_px;
    in.at_origin.x() = (scale.u_offset + shift_px) / in.turn_px;
  }
  return in;
}

/// Returns a caption's coordinates of a position in the picture; NaN where it has none.
Eigen::Vector2d on_caption(const PictureShape& picture, const Eigen::Matrix3d& to_caption, const PicturePlace& place) {
  Eigen::Vector3d seen(place.across, place.up, 1.0);
  if (std::holds_alternative<Fisheye>(picture))
    seen = R_eye_picture(picture).transpose() * direction_of(picture, place).normalized();
  const Eigen::Vector3d at = to_caption * seen;
  return at.z() > 0.0 ? Eigen::Vector2d(at.head<2>() / at.z())
                      : Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
}

/// Width of a whole turn in captions; very large in pictures of which no position has a second one.
double caption_turn(const PictureShape& picture, double caption_width) {
  constexpr double kNever = 1e6;
  return std::holds_alternative<Panorama>(picture) ? 2.0 * std::numbers::pi / caption_width : kNever;
}

}  // namespace

Texels texels_for(const output::Gl& gl, const std::vector<HeadPlan>& plans) {
  const bool is_plain = std::ranges::none_of(plans, [](const HeadPlan& plan) {
    return plan.depth_bits > 8 || plan.colour.matrix || plan.colour.black_lift || plan.colour.response;
  });
  if (!is_software_renderer(gl.renderer()) || !is_plain) return Texels::kHalves;
  HeadFeatures features;
  features.texels = Texels::kPacked;
  // kPacked is not available with OpenGL ES 3.0.
  return HeadProgram::make(gl, features) ? Texels::kPacked : Texels::kHalves;
}

HeadPainter::HeadPainter(const output::Gl& gl, const HeadUpload& upload, Texels texels)
    : gl_(&gl),
      width_px_(upload.width_px),
      height_px_(upload.height_px),
      picture_(upload.picture),
      packing_(upload.packing),
      colour_(upload.colour),
      mesh_(gl),
      vertices_(gl),
      indices_(gl),
      mask_(gl),
      map_(gl),
      response_(gl),
      texels_(texels),
      features_(upload.features),
      grid_(upload.grid) {
  set_depth(upload.depth_bits);
}

void HeadPainter::set_depth(int depth_bits) {
  CHECK(depth_bits >= 1 && depth_bits <= 16);
  code_step_ = 1.0f / static_cast<float>((1 << depth_bits) - 1);
}

Result<HeadPainter> HeadPainter::make(const output::Gl& gl, HeadPrograms* programs, const HeadUpload& upload,
                                      Texels texels) {
  HeadPainter painter(gl, upload, texels);
  painter.upload_textures(upload);
  painter.upload_triangles(upload);
  HeadFeatures features = upload.features;
  features.texels = texels;
  const auto add = [&](Part* part, std::size_t first, std::size_t count, bool masked) -> Status {
    if (count == 0) return Done{};
    features.mask = masked || features.black_lift;
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
  TRY(add(&painter.parts_[0], 0, upload.wholly_lit, false));
  TRY(add(&painter.parts_[1], upload.wholly_lit, upload.indices.size() - upload.wholly_lit, true));
  TRY(gl.check("uploading a warp, a mask and a response"));
  return painter;
}

void HeadPainter::upload_triangles(const HeadUpload& upload) {
  gl_->BindVertexArray(mesh_.id());
  gl_->BindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  gl_->BufferData(GL_ARRAY_BUFFER, byte_count(upload.corners), upload.corners.data(), GL_STATIC_DRAW);
  gl_->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.id());
  gl_->BufferData(GL_ELEMENT_ARRAY_BUFFER, byte_count(upload.indices), upload.indices.data(), GL_STATIC_DRAW);
  constexpr std::size_t kFirstTerm = HeadUpload::kCornerFloats;
  const std::size_t corner_floats = kFirstTerm + (upload.has_terms ? HeadUpload::kTermFloats : 0);
  const auto attribute = [&](GLuint index, GLint floats, std::size_t from) {
    gl_->EnableVertexAttribArray(index);
    // GL's convention: an offset into the bound buffer, passed as a pointer.
    gl_->VertexAttribPointer(index, floats, GL_FLOAT, GL_FALSE, static_cast<GLsizei>(corner_floats * sizeof(float)),
                             reinterpret_cast<const void*>(from * sizeof(float)));
  };
  attribute(HeadProgram::kPosition, 2, 0);
  attribute(HeadProgram::kDirection, 2, 2);
  if (!upload.has_terms) return;
  for (const GLuint third : {0U, 1U, 2U}) attribute(HeadProgram::kTerms + third, 4, kFirstTerm + 4 * third);
}

void HeadPainter::upload_textures(const HeadUpload& upload) {
  gl_->ActiveTexture(GL_TEXTURE0);
  gl_->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  const auto per_pixel = [&](const output::GlTexture& texture, GLint kept_as, const HeadUpload::PerPixel& pixels) {
    if (pixels.values.empty()) return;
    upload_nearest(*gl_, texture, kept_as, pixels.channels == 2 ? GL_RG : GL_RED, width_px_, height_px_, pixels.values);
  };
  per_pixel(mask_, upload.mask.channels == 2 ? GL_RG16F : GL_R16F, upload.mask);
  per_pixel(map_, GL_RG32F, upload.map);
  if (upload.packing) {  // The second eye's pixels begin where the first eye's end.
    for (const output::GlTexture* const texture : {&mask_, &map_}) {
      gl_->BindTexture(GL_TEXTURE_2D, texture->id());
      gl_->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_REPEAT);
      gl_->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_REPEAT);
    }
  }
  if (!upload.response.empty()) upload_nearest(*gl_, response_, GL_R32F, GL_RED, kResponseSteps, 3, upload.response);
}

void HeadPainter::use(const HeadProgram& program, const TurnedPicture& shown, const TurnedPicture* other, double fade,
                      Eye eye) const {
  gl_->UseProgram(program.id());
  const auto picture = [&](const HeadProgram::Picture& uniforms, const TurnedPicture& turned, GLenum unit) {
    const PictureShape& shape = turned.picture->shape();
    CHECK(has_same_places(shape, picture_));
    CHECK(turned.picture->texels() == texels_);
    const InTexture in = in_texture(turned, eye);
    const auto* const panorama = std::get_if<Panorama>(&shape);
    gl_->Uniform2f(uniforms.per_texel, 1.0f / static_cast<float>(turned.picture->texture_width()),
                   1.0f / static_cast<float>(turned.picture->texture_height()));
    constexpr double kFirst = PanoramaTexture::kFirstColumn;
    if (in.wraps) {
      gl_->Uniform3f(uniforms.turn, 1.0f, static_cast<float>(in.turn_px / in.width),
                     static_cast<float>((kFirst - in.zero) / in.width));
    } else {
      gl_->Uniform3f(uniforms.turn, 0.0f, 1.0f, 0.0f);
    }
    const auto set = [&](GLint uniform, double x, double y, double z, double w) {
      gl_->Uniform4f(uniform, static_cast<float>(x), static_cast<float>(y), static_cast<float>(z),
                     static_cast<float>(w));
    };
    set(uniforms.to_texture, in.per_position.x(), in.per_position.y(), in.at_origin.x(), in.at_origin.y());
    if (panorama == nullptr) {
      const Eigen::Matrix3f matrix = turning(shape, turned.yaw_shift_rad, in.per_position, in.at_origin).cast<float>();
      gl_->UniformMatrix3fv(uniforms.turned, 1, GL_FALSE, matrix.data());  // Column by column, as GL expects.
    }
    const double beyond = in.wraps ? 0.5 : -0.5;  // The outer columns of a whole turn repeat the opposite side.
    set(uniforms.edges, (kFirst - beyond - in.zero) / in.width, (in.first_row + 0.5 - in.zero) / in.height,
        (kFirst + width_px(shape) + beyond - in.zero) / in.width,
        (in.first_row + height_px(shape) - 0.5 - in.zero) / in.height);
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

Status HeadPainter::set_caption(HeadPrograms* programs, const Caption* caption) {
  caption_box_ = {};
  if (caption == nullptr) return Done{};
  to_caption_ = to_caption(picture_, *caption);
  caption_size_ = {caption->width, caption->height};
  constexpr int kColumns = HeadUpload::kGridColumns;
  constexpr int kRows = HeadUpload::kGridRows;
  const double turn = caption_turn(picture_, caption->width);
  int left = kColumns;
  int right = -1;
  int top = kRows;
  int bottom = -1;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      Eigen::AlignedBox2d cell;
      for (const int corner : {0, 1, 2, 3}) {
        const int index = (row + corner / 2) * (kColumns + 1) + column + corner % 2;
        Eigen::Vector2d at = on_caption(picture_, to_caption_, grid_[static_cast<std::size_t>(index)]);
        at.x() -= turn * std::floor((at.x() - 0.5) / turn + 0.5);
        if (at.allFinite()) cell.extend(at);
      }
      if (cell.isEmpty()) continue;
      // Between its corners, a cell may reach farther than they do.
      const Eigen::Vector2d more = 0.25 * cell.sizes();
      cell.min() -= more;
      cell.max() += more;
      if (!cell.intersects(Eigen::AlignedBox2d(Eigen::Vector2d::Zero(), Eigen::Vector2d::Ones()))) continue;
      left = std::min(left, column);
      right = std::max(right, column);
      top = std::min(top, row);
      bottom = std::max(bottom, row);
    }
  }
  if (right < left) return Done{};
  const auto at = [](int cell, int cells, int px) { return (cell * px) / cells; };
  const int x = at(left, kColumns, width_px_);
  const int y = height_px_ - at(bottom + 1, kRows, height_px_);
  caption_box_ = {x, y, at(right + 1, kColumns, width_px_) - x, height_px_ - at(top, kRows, height_px_) - y};
  if (caption_program_ != nullptr) return Done{};
  HeadFeatures features = features_;
  features.texels = texels_;
  // One program for all cases: it draws little.
  features.mask = features.edges = features.fade = features.caption = true;
  TRY_ASSIGN(caption_program_, programs->get(features));
  return Done{};
}

void HeadPainter::use_caption(const HeadProgram& program, const TurnedPicture& shown, Eye eye,
                              const ShownCaption& caption) const {
  const PictureShape& shape = shown.picture->shape();
  const InTexture in = in_texture(shown, eye);
  Eigen::Matrix3d matrix = to_caption_;
  if (std::holds_alternative<Panorama>(shape)) {
    Eigen::Matrix3d to_place;
    to_place << 1.0 / in.per_position.x(), 0.0, -in.at_origin.x() / in.per_position.x(),  //
        0.0, 1.0 / in.per_position.y(), -in.at_origin.y() / in.per_position.y(),          //
        0.0, 0.0, 1.0;
    matrix = to_caption_ * to_place;
  } else if (std::holds_alternative<Perspective>(shape)) {
    matrix = to_caption_ * turning(shape, shown.yaw_shift_rad, in.per_position, in.at_origin).inverse();
  }
  const Eigen::Matrix3f rounded = matrix.cast<float>();
  gl_->UniformMatrix3fv(program.to_caption, 1, GL_FALSE, rounded.data());
  gl_->Uniform1f(program.caption_turn, static_cast<float>(caption_turn(picture_, caption_size_.x())));
  const auto width = static_cast<float>(caption.texture_width_px);
  const auto height = static_cast<float>(caption.texture_height_px);
  gl_->Uniform4f(program.caption_part, static_cast<float>(caption.width_px) / width,
                 static_cast<float>(caption.height_px) / height, 0.5f / width, 0.5f / height);
  // The edge is soft over a few pixels of the ink, which has a margin.
  constexpr float kSoftPx = 6.0f;
  gl_->Uniform2f(program.caption_edge, static_cast<float>(caption.width_px) / kSoftPx,
                 static_cast<float>(caption.height_px) / kSoftPx);
  gl_->Uniform1f(program.caption_share, static_cast<float>(caption.share));
  gl_->ActiveTexture(GL_TEXTURE0 + HeadProgram::kCaption);
  gl_->BindTexture(GL_TEXTURE_2D, caption.texture);
}

void HeadPainter::draw_for(Eye eye, const Pass& pass, int x_px, int y_px) const {
  const auto elements = [this](GLsizei first, GLsizei count) {
    const std::size_t offset = static_cast<std::size_t>(first) * sizeof(std::uint32_t);
    gl_->DrawElements(GL_TRIANGLES, count, GL_UNSIGNED_INT,
                      reinterpret_cast<const void*>(offset));  // NOLINT(performance-no-int-to-ptr)
  };
  if (pass.caption != nullptr) {
    const TurnedPicture& other = pass.other == nullptr ? *pass.shown : *pass.other;
    use(*caption_program_, *pass.shown, &other, pass.fade, eye);
    use_caption(*caption_program_, *pass.shown, eye, *pass.caption);
    if (pass.is_cut) {
      gl_->Enable(GL_SCISSOR_TEST);
      gl_->Scissor(x_px + caption_box_.x, y_px + caption_box_.y, caption_box_.width, caption_box_.height);
    }
    elements(0, parts_[0].count + parts_[1].count);
    gl_->Disable(GL_SCISSOR_TEST);
    return;
  }
  for (const Part& part : parts_) {
    if (part.count == 0) continue;
    use(*part.programs[pass.edges ? 1 : 0][pass.other == nullptr ? 0 : 1], *pass.shown, pass.other, pass.fade, eye);
    elements(part.first, part.count);
  }
}

void HeadPainter::clear() const {
  gl_->ClearColor(0.0f, 0.0f, 0.0f, 1.0f);
  gl_->Clear(GL_COLOR_BUFFER_BIT);
}

void HeadPainter::draw(const Pass& pass, Eye now) const {
  const auto bind = [&](GLenum unit, const output::GlTexture& texture) {
    gl_->ActiveTexture(GL_TEXTURE0 + unit);
    gl_->BindTexture(GL_TEXTURE_2D, texture.id());
  };
  bind(HeadProgram::kMask, mask_);
  bind(HeadProgram::kMap, map_);
  bind(HeadProgram::kResponse, response_);
  gl_->BindVertexArray(mesh_.id());
  if (!packing_ || takes_turns()) return draw_for(packing_ ? now : Eye::kLeft, pass, 0, 0);
  const bool is_beside = packing_ == StereoPacking::kSideBySide;
  const int head_width = is_beside ? 2 * width_px_ : width_px_;
  const int head_height = is_beside ? height_px_ : 2 * height_px_;
  for (const Eye eye : {Eye::kLeft, Eye::kRight}) {
    const HeadPart part = part_of_eye(*packing_, eye, head_width, head_height);
    const int y_px = head_height - part.y_px - part.height_px;
    gl_->Viewport(part.x_px, y_px, part.width_px, part.height_px);
    draw_for(eye, pass, part.x_px, y_px);
  }
}

void HeadPainter::draw_both(const Pass& pass, Eye now, const ShownCaption* caption) const {
  draw(pass, now);
  if (caption == nullptr || caption_box_.empty()) return;
  Pass over = pass;
  over.caption = caption;
  over.is_cut = true;
  draw(over, now);
}

void HeadPainter::draw(const TurnedPicture& shown, Eye now, const ShownCaption* caption) const {
  clear();
  draw_both({&shown, nullptr, 0.0, needs_edges(shown)}, now, caption);
}

void HeadPainter::draw(const TurnedPicture& shown, const TurnedPicture& other, double fade, Eye now,
                       const ShownCaption* caption) const {
  clear();
  draw_both({&shown, &other, fade, needs_edges(shown) || needs_edges(other)}, now, caption);
}

void HeadPainter::draw_over(const TurnedPicture& shown, const TurnedPicture& other, double fade, Eye now,
                            const ShownCaption* caption) const {
  Pass pass{&shown, &other, fade, needs_edges(shown) || needs_edges(other)};
  // The part that the caption covers must not be blended twice.
  if (!caption_box_.empty()) pass.caption = caption;
  draw(pass, now);
}

void HeadPainter::warm_up(const TurnedPicture& shown, const TurnedPicture& other,
                          const std::function<void()>& stepped) const {
  clear();
  for (const bool edges : {false, true}) {
    draw(Pass{&shown, nullptr, 0.0, edges}, Eye::kLeft);
    stepped();
    draw(Pass{&shown, &other, 1.0, edges}, Eye::kLeft);
    stepped();
  }
}

}  // namespace cyclorama::display
