// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/text_font.h"

#include <fmt/format.h>
#include <ft2build.h>

#include <system_error>
#include FT_FREETYPE_H

namespace cyclorama::display {
namespace {

constexpr std::uint32_t kReplacement = 0xFFFD;
constexpr int kSubpixels = 64;  // FreeType's positions are in 1/64 of a pixel.

/// Returns the first character of UTF-8 text, which it removes.
std::uint32_t next_character(std::string_view* text) {
  const auto byte = [&](std::size_t i) {
    return i < text->size() ? static_cast<std::uint32_t>(static_cast<unsigned char>((*text)[i])) : 0U;
  };
  const std::uint32_t first = byte(0);
  const std::size_t more = first < 0x80 ? 0 : first >= 0xF0 ? 3 : first >= 0xE0 ? 2 : 1;
  std::uint32_t character = more == 0 ? first : first & (0x3FU >> more);
  std::size_t used = 1;
  for (; used <= more && (byte(used) & 0xC0U) == 0x80U; ++used) character = character << 6 | (byte(used) & 0x3FU);
  const bool is_whole = used == more + 1 && (first < 0x80 || first >= 0xC2);
  text->remove_prefix(used);
  return is_whole ? character : kReplacement;
}

}  // namespace

struct TextFont::Fonts {
  FT_Library library = nullptr;
  std::vector<FT_Face> faces;

  Fonts() = default;
  ~Fonts() {
    for (const FT_Face face : faces) FT_Done_Face(face);
    if (library != nullptr) FT_Done_FreeType(library);
  }
  Fonts(const Fonts&) = delete;
  Fonts& operator=(const Fonts&) = delete;

  /// Loads the picture of a character. Returns null if no font has one.
  [[nodiscard]] FT_GlyphSlot load(std::uint32_t character, int size_px) const {
    FT_Face face = faces.front();
    for (const FT_Face one : faces) {
      if (FT_Get_Char_Index(one, character) == 0) continue;
      face = one;
      break;
    }
    if (FT_Set_Pixel_Sizes(face, 0, static_cast<FT_UInt>(size_px)) != 0) return nullptr;
    return FT_Load_Char(face, character, FT_LOAD_RENDER) == 0 ? face->glyph : nullptr;
  }
};

Result<TextFont> TextFont::open(const std::vector<std::filesystem::path>& files) {
  auto fonts = std::make_shared<Fonts>();
  if (FT_Init_FreeType(&fonts->library) != 0) return Error(ErrorCode::kSystem, "FreeType does not start");
  for (const std::filesystem::path& file : files) {
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) {
      return Error(
          ErrorCode::kNotFound,
          fmt::format("the font '{}' is missing; install fonts-dejavu-core and fonts-droid-fallback", file.string()));
    }
    FT_Face face = nullptr;
    if (FT_New_Face(fonts->library, file.c_str(), 0, &face) != 0) {
      return Error(ErrorCode::kBadData, fmt::format("'{}' is no font; install its package again", file.string()));
    }
    fonts->faces.push_back(face);
  }
  if (fonts->faces.empty()) return Error(ErrorCode::kInvalidArgument, "no font is named");
  return TextFont(std::move(fonts));
}

Result<TextFont> TextFont::open_installed() {
  return open(
      {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf", "/usr/share/fonts/truetype/droid/DroidSansFallbackFull.ttf"});
}

int TextFont::width_px(std::string_view line, int size_px) const {
  long width = 0;
  while (!line.empty()) {
    const FT_GlyphSlot glyph = fonts_->load(next_character(&line), size_px);
    if (glyph != nullptr) width += glyph->advance.x;
  }
  return static_cast<int>(width / kSubpixels);
}

void TextFont::draw(std::string_view line, int size_px, int x, int y, const Colour& colour,
                    RgbaImage* ret_picture) const {
  long at = long{x} * kSubpixels;
  while (!line.empty()) {
    const FT_GlyphSlot glyph = fonts_->load(next_character(&line), size_px);
    if (glyph == nullptr) continue;
    const int left = static_cast<int>(at / kSubpixels) + glyph->bitmap_left;
    const int top = y - glyph->bitmap_top;
    for (int row = 0; row < static_cast<int>(glyph->bitmap.rows); ++row) {
      for (int column = 0; column < static_cast<int>(glyph->bitmap.width); ++column) {
        const int px = left + column;
        const int py = top + row;
        if (px < 0 || py < 0 || px >= ret_picture->width() || py >= ret_picture->height()) continue;
        const int share = glyph->bitmap.buffer[row * glyph->bitmap.pitch + column];
        std::uint8_t* const pixel = ret_picture->at(px, py);
        for (std::size_t c = 0; c < colour.size(); ++c) {
          pixel[c] = static_cast<std::uint8_t>((pixel[c] * (255 - share) + colour[c] * share + 127) / 255);
        }
      }
    }
    at += glyph->advance.x;
  }
}

}  // namespace cyclorama::display
