// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/caption/caption_setter.h"

#include <fmt/format.h>
#include <fontconfig/fontconfig.h>
#include <pango/pangofc-fontmap.h>
#include <pango/pangoft2.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "common/base/text.h"
#include "kiosk/tour/plan/characters.h"

namespace cyclorama::tour {
namespace {

constexpr const char* kFontFolder = "/usr/share/fonts";
/// The first that has a letter is used, and after these any installed font. The package depends on both.
constexpr const char* kFamilies = "DejaVu Sans, Droid Sans Fallback";
constexpr double kCapitals = 0.729;    ///< Height of a capital letter of DejaVu Sans, in parts of the font's size.
constexpr double kMargin = 0.6;        ///< Around the letters, in parts of the font's size.
constexpr double kGap = 0.5;           ///< Between two languages, likewise.
constexpr double kTitleLarger = 1.15;  ///< Size of a title in relation to its text.

struct Unref {
  void operator()(void* object) const { g_object_unref(object); }
};
template <typename T>
using Owned = std::unique_ptr<T, Unref>;
using Description =
    std::unique_ptr<PangoFontDescription,
                    decltype([](PangoFontDescription* description) { pango_font_description_free(description); })>;
using Iterator =
    std::unique_ptr<PangoLayoutIter, decltype([](PangoLayoutIter* iterator) { pango_layout_iter_free(iterator); })>;
using FontConfig = std::unique_ptr<FcConfig, decltype([](FcConfig* config) { FcConfigDestroy(config); })>;

int in_pango(double px) { return static_cast<int>(px * PANGO_SCALE); }

bool is_font(const std::filesystem::path& file) {
  const std::string ending = file.extension().string();
  return ending == ".ttf" || ending == ".otf" || ending == ".ttc";
}

/// Returns a configuration with the installed fonts and nothing else: the settings of a computer or of a user would make
/// lines break elsewhere. Files are read one by one, since reading a folder writes a cache into the user's folder.
FontConfig installed_fonts(std::size_t* ret_count) {
  FontConfig config(FcConfigCreate());
  *ret_count = 0;
  std::error_code error;
  std::vector<std::filesystem::path> files;
  for (std::filesystem::recursive_directory_iterator file(kFontFolder, error), end; !error && file != end;
       file.increment(error)) {
    if (is_font(file->path())) files.push_back(file->path());
  }
  std::ranges::sort(files);
  for (const std::filesystem::path& file : files) {
    // FcChar8 is an unsigned char.
    if (FcConfigAppFontAddFile(config.get(), reinterpret_cast<const FcChar8*>(file.c_str())) == FcTrue) ++*ret_count;
  }
  return config;
}

/// One line of a text, whose layout owns it.
struct Line {
  PangoLayoutLine* line = nullptr;
  int left = 0;  ///< In units of Pango, as all lengths here.
  int above = 0;
  int height = 0;
  std::size_t characters = 0;
};

/// One language's text, laid out.
struct Block {
  Owned<PangoLayout> layout;
  std::vector<std::vector<Line>> pages;
};

int height_of(const std::vector<Line>& lines) {
  int height = 0;
  for (const Line& line : lines) height += line.height;
  return height;
}

Owned<PangoLayout> laid_out(PangoContext* context, const CaptionText& text, const CaptionSize& size) {
  Owned<PangoLayout> layout(pango_layout_new(context));
  const std::string all = text.title.empty() ? text.text : text.title + "\n" + text.text;
  const Description font(pango_font_description_from_string(kFamilies));
  pango_font_description_set_absolute_size(font.get(), size.letters_px / kCapitals * PANGO_SCALE);
  pango_layout_set_font_description(layout.get(), font.get());
  pango_layout_set_text(layout.get(), all.data(), static_cast<int>(all.size()));
  PangoAttrList* const attributes = pango_attr_list_new();
  pango_attr_list_insert(attributes, pango_attr_language_new(pango_language_from_string(text.language.c_str())));
  for (PangoAttribute* const of_title :
       {pango_attr_weight_new(PANGO_WEIGHT_BOLD), pango_attr_scale_new(kTitleLarger)}) {
    of_title->start_index = 0;
    of_title->end_index = static_cast<guint>(text.title.size());
    pango_attr_list_insert(attributes, of_title);
  }
  pango_layout_set_attributes(layout.get(), attributes);
  pango_attr_list_unref(attributes);
  pango_layout_set_wrap(layout.get(), PANGO_WRAP_WORD_CHAR);
  pango_layout_set_alignment(layout.get(), text.is_centred ? PANGO_ALIGN_CENTER : PANGO_ALIGN_LEFT);
  pango_layout_set_width(layout.get(), in_pango(size.width_px));
  return layout;
}

int width_of(PangoLayout* layout) {
  PangoRectangle logical;
  pango_layout_get_extents(layout, nullptr, &logical);
  return logical.width;
}

std::vector<std::vector<Line>> pages_of(PangoLayout* layout, int lines_per_page) {
  std::vector<Line> lines;
  const std::string_view text = pango_layout_get_text(layout);
  const Iterator at(pango_layout_get_iter(layout));
  do {
    PangoRectangle logical;
    pango_layout_iter_get_line_extents(at.get(), nullptr, &logical);
    Line line{pango_layout_iter_get_line_readonly(at.get()), logical.x,
              pango_layout_iter_get_baseline(at.get()) - logical.y, logical.height, 0};
    line.characters = character_count(
        text.substr(static_cast<std::size_t>(line.line->start_index), static_cast<std::size_t>(line.line->length)));
    lines.push_back(line);
  } while (pango_layout_iter_next_line(at.get()) != FALSE);
  // Pages of about the same length, so that the last one is no single word.
  const auto count = static_cast<int>(lines.size());
  const int page_count = (count + lines_per_page - 1) / lines_per_page;
  std::vector<std::vector<Line>> pages;
  pages.reserve(static_cast<std::size_t>(page_count));
  for (int page = 0; page < page_count; ++page)
    pages.emplace_back(lines.begin() + count * page / page_count, lines.begin() + count * (page + 1) / page_count);
  return pages;
}

void draw(const std::vector<Line>& lines, int left, int top, GreyImage* ret_ink) {
  FT_Bitmap bitmap{};
  bitmap.rows = static_cast<unsigned>(ret_ink->height());
  bitmap.width = static_cast<unsigned>(ret_ink->width());
  bitmap.pitch = ret_ink->width();
  bitmap.buffer = ret_ink->data().data();
  bitmap.num_grays = 256;
  bitmap.pixel_mode = FT_PIXEL_MODE_GRAY;
  for (const Line& line : lines) {
    pango_ft2_render_layout_line_subpixel(&bitmap, line.line, left + line.left, top + line.above);
    top += line.height;
  }
}

}  // namespace

struct CaptionSetter::Fonts {
  FontConfig config;
  Owned<PangoFontMap> map;
};

CaptionSetter::CaptionSetter(std::unique_ptr<Fonts> fonts) : fonts_(std::move(fonts)) {}
CaptionSetter::CaptionSetter(CaptionSetter&&) noexcept = default;
CaptionSetter& CaptionSetter::operator=(CaptionSetter&&) noexcept = default;
CaptionSetter::~CaptionSetter() = default;

Result<CaptionSetter> CaptionSetter::open() {
  auto fonts = std::make_unique<Fonts>();
  std::size_t count = 0;
  fonts->config = installed_fonts(&count);
  if (count == 0) {
    return Error(ErrorCode::kNotFound,
                 fmt::format("no font is in {}; install fonts-dejavu-core and fonts-droid-fallback", kFontFolder));
  }
  fonts->map.reset(pango_ft2_font_map_new());
  pango_fc_font_map_set_config(PANGO_FC_FONT_MAP(fonts->map.get()), fonts->config.get());
  return CaptionSetter(std::move(fonts));
}

Result<std::vector<CaptionPage>> CaptionSetter::set(const std::vector<CaptionText>& texts,
                                                    const CaptionSize& size) const {
  const Owned<PangoContext> context(pango_font_map_create_context(fonts_->map.get()));
  pango_context_set_round_glyph_positions(context.get(), FALSE);
  std::vector<Block> blocks;
  int width = 0;
  for (const CaptionText& text : texts) {
    if (text.title.empty() && text.text.empty()) continue;
    Owned<PangoLayout> layout = laid_out(context.get(), text, size);
    if (const int unknown = pango_layout_get_unknown_glyphs_count(layout.get()); unknown > 0) {
      return Error(
          ErrorCode::kNotFound,
          fmt::format("no installed font has {} of the letters of a text in '{}'; install one, such as Debian's "
                      "fonts-noto-core or fonts-noto-cjk",
                      unknown, printable(text.language)));
    }
    width = std::max(width, width_of(layout.get()));
    blocks.push_back({std::move(layout), {}});
  }
  std::size_t page_count = 0;
  for (Block& block : blocks) {
    // Lines that run from the right end where the longest line does. One pixel more keeps rounding from breaking it.
    pango_layout_set_width(block.layout.get(), width + PANGO_SCALE);
    block.pages = pages_of(block.layout.get(), size.lines);
    page_count = std::max(page_count, block.pages.size());
  }
  const int font = in_pango(size.letters_px / kCapitals);
  const auto part = [font](double share) { return static_cast<int>(share * font); };
  std::vector<CaptionPage> pages;
  for (std::size_t number = 0; number < page_count; ++number) {
    int height = 2 * part(kMargin) + static_cast<int>(blocks.size() - 1) * part(kGap);
    const auto lines_of = [number](const Block& block) -> const std::vector<Line>& {
      return block.pages[std::min(number, block.pages.size() - 1)];
    };
    for (const Block& block : blocks) height += height_of(lines_of(block));
    const int width_px = PANGO_PIXELS_CEIL(width + PANGO_SCALE + 2 * part(kMargin));
    const int height_px = PANGO_PIXELS_CEIL(height);
    if (width_px > kMaxCaptionWidthPx || height_px > kMaxCaptionHeightPx) {
      return Error(ErrorCode::kInvalidArgument,
                   fmt::format("captions of {} x {} pixels are too large; at most {} x {} are possible", width_px,
                               height_px, kMaxCaptionWidthPx, kMaxCaptionHeightPx));
    }
    CaptionPage page{GreyImage(width_px, height_px), 0};
    int top = part(kMargin);
    for (const Block& block : blocks) {
      const std::vector<Line>& lines = lines_of(block);
      draw(lines, part(kMargin), top, &page.ink);
      top += height_of(lines) + part(kGap);
      for (const Line& line : lines) page.characters += line.characters;
    }
    pages.push_back(std::move(page));
  }
  return pages;
}

}  // namespace cyclorama::tour
