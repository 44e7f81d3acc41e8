// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama::display {

/// Draws lines of text with FreeType. A character comes from the first font that has it. Thread-bound.
class TextFont {
 public:
  using Colour = std::array<std::uint8_t, 3>;  ///< sRGB.

  /// Errors: kNotFound with the package to install if a file is missing, kBadData if it is no font.
  static Result<TextFont> open(const std::vector<std::filesystem::path>& files);
  /// Opens the fonts that the package cyclorama-museum depends on: Latin letters, and Chinese.
  static Result<TextFont> open_installed();

  /// Width of a line of UTF-8 in pixels.
  [[nodiscard]] int width_px(std::string_view line, int size_px) const;
  /// Draws a line whose left end and baseline are at (x, y). What lies outside of the picture is cut off.
  void draw(std::string_view line, int size_px, int x, int y, const Colour& colour, RgbaImage* ret_picture) const;

 private:
  struct Fonts;
  explicit TextFont(std::shared_ptr<Fonts> fonts) : fonts_(std::move(fonts)) {}
  std::shared_ptr<Fonts> fonts_;
};

}  // namespace cyclorama::display
