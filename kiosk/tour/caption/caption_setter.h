// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama::tour {

/// A text in one language, below a title in bold or none.
struct CaptionText {
  std::string language;  ///< Its tag chooses between the shapes that languages give to one letter.
  std::string title;
  std::string text;  ///< Lines are separated by '\n'.
  bool is_centred = false;
  friend bool operator==(const CaptionText&, const CaptionText&) = default;
};

struct CaptionSize {
  int letters_px = 16;  ///< Height of a capital letter; 4 to 400.
  int width_px = 600;   ///< Width of the lines, at most; at least 10 letters' heights.
  int lines = 4;        ///< Lines on a page for one language, at most; at least 1.
  friend bool operator==(const CaptionSize&, const CaptionSize&) = default;
};

struct CaptionPage {
  GreyImage ink;               ///< Coverage by letters, with a margin.
  std::size_t characters = 0;  ///< For the time in which it is read.
};

inline constexpr int kMaxCaptionWidthPx = 4096;
inline constexpr int kMaxCaptionHeightPx = 2048;

/// Sets texts in any script, from left to right or from right to left, with Pango and HarfBuzz, and cuts long ones into
/// pages. It uses the installed fonts, and no settings of the computer's. Thread-bound.
class CaptionSetter {
 public:
  /// Errors: kNotFound, with the remedy, if no font is installed.
  static Result<CaptionSetter> open();
  CaptionSetter(CaptionSetter&&) noexcept;
  CaptionSetter& operator=(CaptionSetter&&) noexcept;
  ~CaptionSetter();

  /// Sets the texts below each other; where one has fewer pages than another, its last page stays. Texts without
  /// letters are left out, and without any there are no pages. Errors: kNotFound, with the language and the remedy, if
  /// no installed font has some letters; kInvalidArgument if a page would be larger than kMaxCaptionWidthPx and
  /// kMaxCaptionHeightPx.
  [[nodiscard]] Result<std::vector<CaptionPage>> set(const std::vector<CaptionText>& texts,
                                                     const CaptionSize& size) const;

 private:
  struct Fonts;
  explicit CaptionSetter(std::unique_ptr<Fonts> fonts);
  std::unique_ptr<Fonts> fonts_;
};

}  // namespace cyclorama::tour
