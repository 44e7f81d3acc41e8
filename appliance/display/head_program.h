// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "appliance/display/texels.h"
#include "drivers/output/gl_objects.h"

namespace cyclorama::display {

/// Effect of a turn on a picture's positions (common/geometry/picture_place.h).
enum class YawCorrection {
  kShift,    ///< Panorama: all positions move by the same amount.
  kFlat,     ///< Perspective: a homography; straight lines stay straight.
  kFisheye,  ///< Fisheye: each position moves along a curve.
};

/// Source of a pixel's position in the picture.
enum class WarpKind {
  kTriangles,  ///< Linear interpolation between the corners of a triangle.
  kPatches,    ///< A polynomial of second degree in each rectangle.
  kPixelMap,   ///< A texture.
};

/// Features that the shader of pass 2, which draws a projector's picture, needs for a group of triangles. Only these
/// are compiled in.
struct HeadFeatures {
  YawCorrection turning = YawCorrection::kShift;
  WarpKind warp_kind = WarpKind::kTriangles;
  Texels texels = Texels::kHalves;
  bool edges = false;  ///< The texture extends beyond the picture's edge, or the picture is a whole turn.
  bool mask = false;
  bool black_lift = false;  ///< Black lift is added; needs `mask`, whose second channel holds it.
  bool matrix = false;
  bool response = false;  ///< The code values come from a table; false: from the sRGB curve.
  bool dither = false;
  bool fade = false;     ///< Two pictures are mixed.
  bool caption = false;  ///< A caption is drawn over the picture.

  friend auto operator<=>(const HeadFeatures&, const HeadFeatures&) = default;
};

/// Pass 2's shader with a set of features. For each pixel it computes the position in the picture and reads the light
/// there, filtered linearly (half floats by the card, whose filter weights may have as few as 8 bits; packed texels by
/// the shader). Then it applies mask, matrix, black lift, response and dither. Thread-bound to the GL context.
class HeadProgram {
 public:
  /// Errors: kSystem if the driver's compiler refuses the shader, with its message.
  static Result<HeadProgram> make(const output::Gl& gl, const HeadFeatures& features);

  enum Unit : GLint { kPicture, kOther, kMask, kMap, kResponse, kCaption };
  static constexpr GLuint kPosition = 0;  ///< Attribute: position in clip space.
  /// Attribute: azimuth and tangent of elevation, or the position in another projection. With kPatches: s, t.
  static constexpr GLuint kDirection = 1;
  /// Three attributes, only with kPatches: coefficients of 1 and s, of t and s^2, of s t and t^2.
  static constexpr GLuint kTerms = 2;

  [[nodiscard]] const HeadFeatures& features() const { return features_; }
  [[nodiscard]] GLuint id() const { return program_.id(); }

  /// Uniforms of one of the two pictures.
  struct Picture {
    /// The position in the texture is direction * xy + zw; x counts whole turns if the picture is a whole turn.
    GLint to_texture = -1;
    /// With kFlat: maps (position, 1) to the texture, homogeneously. With kFisheye: rotates directions.
    GLint turned = -1;
    GLint turn = -1;       ///< x is 1 for a whole turn, else 0. For a whole turn, the texture's x is fract(x) * y + z.
    GLint edges = -1;      ///< Minimum x and y, then maximum x and y.
    GLint per_texel = -1;  ///< With kPacked: 1 / the texture's size.
  };
  Picture picture;
  Picture other;
  GLint fade = -1;        ///< Share of the other picture.
  GLint per_px = -1;      ///< 1 / the head's size.
  GLint matrix = -1;      ///< Colour matrix, column by column.
  GLint black = -1;       ///< Black level of the other projectors, in linear light.
  GLint response = -1;    ///< Scale and offset from light to the table: (steps - 1) / steps, 0.5 / steps.
  GLint to_caption = -1;  ///< Matrix to the caption, from `at`; with kFisheye from the direction in the picture's axes.
  GLint caption_turn = -1;  ///< Width of a whole turn in captions; very large where the picture has none.
  GLint caption_part = -1;  ///< Size of the caption in its texture, then half a texel.
  GLint caption_edge = -1;  ///< 1 / the width of the plate's soft edge, as a part of the caption.
  GLint caption_share = -1;
  GLint step = -1;  ///< Step of the output's code values; 1 / 255 for 8 bits.

 private:
  HeadProgram(output::GlProgram program, const HeadFeatures& features)
      : program_(std::move(program)), features_(features) {}
  output::GlProgram program_;
  HeadFeatures features_;
};

/// The programs of a context's heads, each made when it is first requested. Thread-bound; borrows the Gl table.
class HeadPrograms {
 public:
  explicit HeadPrograms(const output::Gl& gl) : gl_(gl) {}
  /// Returns a program that lives as long as this object. Errors: those of HeadProgram::make().
  Result<const HeadProgram*> get(const HeadFeatures& features);

 private:
  const output::Gl& gl_;
  std::vector<std::unique_ptr<HeadProgram>> programs_;
};

}  // namespace cyclorama::display
