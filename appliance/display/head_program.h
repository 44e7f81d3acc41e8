// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "appliance/display/texels.h"
#include "drivers/output/gl_objects.h"

namespace cyclorama::display {

/// How a turn moves the places of a picture (common/geometry/picture_place.h).
enum class YawCorrection {
  kShift,    ///< Of a panorama: all alike.
  kFlat,     ///< Of a perspective: lines stay straight.
  kFisheye,  ///< Of a fisheye: each on a curve.
};

/// Where a pixel's place comes from.
enum class WarpKind {
  kTriangles,  ///< Even between the corners of a triangle.
  kPatches,    ///< A polynomial of second degree in each rectangle.
  kPixelMap,   ///< A texture.
};

/// What pass 2 must do for some triangles of a head. What it need not do is not compiled in.
struct HeadFeatures {
  YawCorrection turning = YawCorrection::kShift;
  WarpKind warp_kind = WarpKind::kTriangles;
  Texels texels = Texels::kHalves;
  bool edges = false;  ///< The texture does not end where the picture ends, or it is a whole turn.
  bool mask = false;
  bool black_lift = false;  ///< Black is added; needs `mask`, whose second channel it is.
  bool matrix = false;
  bool response = false;  ///< A table of code values; else sRGB.
  bool dither = false;
  bool fade = false;  ///< Two pictures are mixed.

  friend auto operator<=>(const HeadFeatures&, const HeadFeatures&) = default;
};

/// Pass 2's shader with some features. For each pixel: where in the picture it lies; the light there, filtered in
/// linear light (halves by the card, whose weights may have as few as 8 bits, a 256th of a pixel; packed texels by the
/// shader); mask, matrix, black, response, dithering. Thread-bound to the GL context.
class HeadProgram {
 public:
  /// kSystem  the driver's compiler refuses the shader, and why.
  static Result<HeadProgram> make(const output::Gl& gl, const HeadFeatures& features);

  enum Unit : GLint { kPicture, kOther, kMask, kMap, kResponse };
  static constexpr GLuint kPosition = 0;  ///< Attribute: in clip space.
  static constexpr GLuint kDirection =
      1;                               ///< Attribute: azimuth, tangent of elevation; or other places. kPatches: s, t.
  static constexpr GLuint kTerms = 2;  ///< kPatches, three attributes: of 1 and s, of t and s^2, of s t and t^2.

  [[nodiscard]] const HeadFeatures& features() const { return features_; }
  [[nodiscard]] GLuint id() const { return program_.id(); }

  /// Uniforms of one of the two pictures.
  struct Picture {
    GLint to_texture = -1;  ///< Position in the texture = direction * xy + zw; x in turns, where it is a whole turn.
    GLint turned = -1;      ///< kFlat: from (place, 1) to the texture, times the third; kFisheye: turns directions.
    GLint turn = -1;        ///< x: 1 for a whole turn, else 0; then x = fract(x) * y + z.
    GLint edges = -1;       ///< Least x, y, most x, y.
    GLint per_texel = -1;   ///< kPacked: 1 / the texture's size.
  };
  Picture picture;
  Picture other;
  GLint fade = -1;      ///< How much of the other.
  GLint per_px = -1;    ///< 1 / the head's size.
  GLint matrix = -1;    ///< Column by column.
  GLint black = -1;     ///< Linear light.
  GLint response = -1;  ///< Steps - 1 over steps, 0.5 / steps.
  GLint step = -1;      ///< Of the output's code values, 1 / 255 for 8 bits.

 private:
  HeadProgram(output::GlProgram program, const HeadFeatures& features)
      : program_(std::move(program)), features_(features) {}
  output::GlProgram program_;
  HeadFeatures features_;
};

/// The programs of a context's heads, each made when it is first asked for. Thread-bound; borrows the Gl table.
class HeadPrograms {
 public:
  explicit HeadPrograms(const output::Gl& gl) : gl_(gl) {}
  /// It lives as long as this. Errors of HeadProgram::make().
  Result<const HeadProgram*> get(const HeadFeatures& features);

 private:
  const output::Gl& gl_;
  std::vector<std::unique_ptr<HeadProgram>> programs_;
};

}  // namespace cyclorama::display
