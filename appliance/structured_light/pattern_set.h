// SPDX-License-Identifier: Apache-2.0
/// Pictures for a projector, by which a camera's pixels are matched to the projector's pixels.
///
///   white  black │ bit 9  its inverse  bit 8  its inverse …  bit 0  its inverse │ phase 0 … N-1 │ then rows
///   ▓▓▓▓   ░░░░  │ ▓▓░░   ░░▓▓         ▓░░▓   ░▓▓░           the finest stripes: 2 pixels wide
///
/// Stripes that encode columns are vertical. Columns count from 0 at the left, rows from 0 at the top; in a
/// position, the first pixel extends from 0 to 1. Levels are code values of the projector, 0 to 1.
///
/// Gray code: column x shows bit b of x ^ (x >> 1), highest bit first, so that neighbours differ in one bit.
///   Source: Inokuchi, Sato and Matsuda, "Range imaging system for 3-D object recognition", ICPR 1984. The order and
///   the pictures are those of OpenCV's structured-light module (a test compares them).
/// XOR code: every bit coarser than the base is shown XORed with the base, so that no stripe is wider than the base's,
///   and interreflected light is the same for a pattern and its inverse.
///   Source: Gupta, Agrawal, Veeraraghavan and Narasimhan, "Structured Light 3D Scanning in the Presence of Global
///   Illumination", CVPR 2011, section 4.
/// Phase shift: N sines of one period, each shifted by 1/N of it; they give the position within a period.
///   Source: Srinivasan, Liu and Halioua, "Automated phase-measuring profilometry", Applied Optics 23 (18), 1984.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/base/result.h"

namespace cyclorama::structured_light {

enum class PatternAxis { kColumns, kRows };
enum class PatternKind { kWhite, kBlack, kBit, kPhase, kLevel };
enum class PatternLight { kAll, kRed, kGreen, kBlue };

/// One picture of a set.
struct PatternPicture {
  PatternKind kind = PatternKind::kWhite;
  PatternAxis axis = PatternAxis::kColumns;  ///< For kBit and kPhase.
  int bit = 0;                               ///< For kBit: 0 is the finest.
  bool is_inverse = false;                   ///< For kBit.
  int step = 0;                              ///< For kPhase: shifted by step / steps of a period.
  double level = 1.0;                        ///< For kLevel: code value, 0 to 1.
  PatternLight light = PatternLight::kAll;

  friend bool operator==(const PatternPicture&, const PatternPicture&) = default;
};

/// The pictures in order, with all parameters that decoding needs. A value.
struct PatternSet {
  int width_px = 0;
  int height_px = 0;
  int base_bit = -1;  ///< Bit whose stripes are XORed onto coarser bits; -1 for plain Gray code.
  double phase_period_px = 0.0;
  int phase_steps = 0;
  std::vector<PatternPicture> pictures;

  friend bool operator==(const PatternSet&, const PatternSet&) = default;
};

/// Returns the number of bits that distinguish `pixels` values: 10 for 1024, 11 for 1025.
[[nodiscard]] int bits_for(int pixels);

struct PatternChoice {
  int width_px = 1920;
  int height_px = 1080;
  int finest_bit = 0;            ///< Finest bit that is shown; the stripes of bit b are 2^(b+1) pixels wide.
  int base_bit = -1;             ///< See PatternSet.
  double phase_period_px = 0.0;  ///< 0 for no phases; else at least 4 and at least twice the finest stripe.
  int phase_steps = 0;           ///< 3 or more with a period. N steps cancel harmonics of the response up to N - 2.
};

/// Returns the set of pictures. White and black come first, since they determine the exposure; then columns, then rows.
/// Errors: kInvalidArgument with the field and its valid range.
Result<PatternSet> structured_light(const PatternChoice& choice);

/// Returns pictures for measuring response curves: for each light, `steps` levels of equally spaced code values from 0
/// to 1. Errors: kInvalidArgument if a size is not 1 to 16384 or `steps` is not 2 to 256.
Result<PatternSet> ramps(int width_px, int height_px, int steps, const std::vector<PatternLight>& lights);

/// Returns, for example, "column bit 3, inverse"; for progress and errors.
[[nodiscard]] std::string name_of(const PatternPicture& picture);

/// Returns the text that read_pattern_set() parses; it is stored beside the photographs of these pictures.
[[nodiscard]] std::string to_text(const PatternSet& set);
/// Parses the result of to_text(). Errors: kBadData with the line and what was expected there.
Result<PatternSet> read_pattern_set(const std::string& text);

}  // namespace cyclorama::structured_light
