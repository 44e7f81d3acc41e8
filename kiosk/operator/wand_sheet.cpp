// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/wand_sheet.h"

#include <fmt/format.h>

#include <cmath>

#include "common/base/check.h"
#include "common/wand/tag_bitmap.h"

namespace cyclorama::operations {
namespace {

constexpr double kCutMm = 0.25;
constexpr double kFoldMm = 0.2;
constexpr double kFlapMm = 9.0;
constexpr double kBarMm = 20.0;

/// Draws the card's lines, in millimetres from the middle of the sheet.
class CardDrawing {
 public:
  CardDrawing(const FoldedCard& card, VectorPage* page)
      : half_panel_(500.0 * card.panel_width_m),
        half_height_(500.0 * card.panel_height_m),
        tag_(1e3 * card.tag_size_m),
        lid_depth_(1e3 * card.lid_depth_m()),
        lid_half_(1e3 * card.lid_half_width_m()),
        page_(page) {}

  void draw_tag(int id, double centre_x) {
    const TagBitmap bitmap = tag_bitmap(id);
    const double cell = tag_ * bitmap.width_in_tags / bitmap.cells;
    const double left = centre_x - 0.5 * cell * bitmap.cells;
    const double top = -0.5 * cell * bitmap.cells;
    std::vector<std::pair<PagePoint, PagePoint>> black;
    for (int y = 0; y < bitmap.cells; ++y) {
      for (int x = 0; x < bitmap.cells; ++x) {
        if (bitmap.is_white(x, y)) continue;
        black.emplace_back(at(left + x * cell, top + y * cell), at(left + (x + 1) * cell, top + (y + 1) * cell));
      }
    }
    page_->fill(black, 0.0);
  }

  /// Draws the edges of a panel in the middle of the sheet, to be cut.
  void draw_panel() {
    cut({{-half_panel_, -half_height_},
         {half_panel_, -half_height_},
         {half_panel_, half_height_},
         {-half_panel_, half_height_},
         {-half_panel_, -half_height_}});
  }

  void draw_lines() {
    for (const double up : {-1.0, 1.0}) {
      const double edge = up * half_height_;
      const double back = edge + up * lid_depth_;
      cut({{-half_panel_, edge}, {-lid_half_, back}, {lid_half_, back}, {half_panel_, edge}});
      fold({-half_panel_, edge}, {half_panel_, edge});
      for (const double side : {-1.0, 1.0}) {
        const double inner = side * half_panel_;
        const double outer = side * 3.0 * half_panel_;
        const double flap = edge + up * kFlapMm;
        // The flap stays clear of the lid's slanted edge.
        cut({{inner, edge}, {inner + side * 2.2 * kFlapMm, flap}, {outer - side * kFlapMm, flap}, {outer, edge}});
        fold({inner, edge}, {outer, edge});
      }
    }
    for (const double side : {-1.0, 1.0}) {
      fold({side * half_panel_, -half_height_}, {side * half_panel_, half_height_});
      cut({{side * 3.0 * half_panel_, -half_height_}, {side * 3.0 * half_panel_, half_height_}});
    }
  }

  /// Draws the scale bar beside the upper lid, where nothing is cut.
  void draw_scale() {
    const double right = 3.0 * half_panel_;
    const double y = -half_height_ - lid_depth_ + 10.0;
    page_->line({at(right - kBarMm, y), at(right, y)}, 0.3);
    for (const double x : {right - kBarMm, right}) page_->line({at(x, y - 1.5), at(x, y + 1.5)}, 0.3);
    page_->text(at(right - kBarMm, y + 5.0), 3.6, fmt::format("{:.0f} mm", kBarMm));
  }
  void write(double x, double y, double height, const std::string& words) { page_->text(at(x, y), height, words); }
  [[nodiscard]] double panel_mm() const { return 2.0 * half_panel_; }
  [[nodiscard]] double top_mm() const { return -half_height_ - lid_depth_; }

 private:
  [[nodiscard]] PagePoint at(double x, double y) const {
    return {0.5 * page_->width_mm() + x, 0.5 * page_->height_mm() + y};
  }
  void cut(const std::vector<PagePoint>& points) {
    std::vector<PagePoint> placed;
    for (const PagePoint& point : points) placed.push_back(at(point.x_mm, point.y_mm));
    page_->line(placed, kCutMm);
  }
  void fold(const PagePoint& from, const PagePoint& to) {
    page_->line({at(from.x_mm, from.y_mm), at(to.x_mm, to.y_mm)}, kFoldMm, true);
  }

  double half_panel_, half_height_, tag_, lid_depth_, lid_half_;
  VectorPage* page_;
};

/// Draws the folded card from above, as the instructions describe it.
void draw_folded(const FoldedCard& card, double scale, const PagePoint& middle, VectorPage* page) {
  const double half = scale * 500.0 * card.panel_width_m;
  const double depth = scale * 1e3 * card.lid_depth_m();
  const double back = scale * 1e3 * card.lid_half_width_m();
  const auto at = [&](double x, double y) { return PagePoint{middle.x_mm + x, middle.y_mm + y}; };
  page->fill({at(-half, depth), at(-back, 0), at(back, 0), at(half, depth)}, 0.9);
  page->line({at(-back, 0), at(-half, depth), at(half, depth), at(back, 0)}, 0.8);
  page->line({at(-back, 0), at(back, 0)}, 0.2, true);
  page->text(at(-10, depth + 8), 5, "camera");
  page->text(at(-20, 0.5 * depth + 1), 5, "lid, from above");
  page->text(at(-8, -4), 5, "hand");
}

VectorPage instructions(int number, const Paper& paper) {
  VectorPage page(paper.width_mm, paper.height_mm);
  const FoldedCard card = card_on(paper);
  const double tag_mm = 1e3 * card.tag_size_m;
  double y = 22.0;
  const auto write = [&](const std::string& words) {
    page.text({20.0, y}, 6.5, words);
    y += 7.5;
  };
  page.text({20.0, y}, 11.0, fmt::format("Cyclorama: wand {}", number));
  y += 13.0;
  write(fmt::format("1. Print the other page on stiff, matt paper (160 to 250 g), at 100 %: not \"fit to page\"."));
  write(fmt::format("   Check it with a ruler: a black square measures {:.1f} mm, the bar beside the lid {:.0f} mm.",
                    tag_mm, kBarMm));
  write("2. Cut along the whole lines, also between lids and flaps. Score the dashed lines with a blunt knife.");
  write("3. Fold every dashed line backwards, away from the print.");
  write("4. Glue the four flaps under the lids, edge to edge: the lids hold the side panels at their angle.");
  write("   The open side is the back: hold it there, or glue a stick to the lower lid.");
  write("5. Where a tour writes on the wall in several languages, cut out the third page and glue it inside the back:");
  write("   whoever turns the wand to the camera chooses the next language.");
  write("6. Fingers stay off the black squares and the white around them. The word TOP is above.");
  write("");
  write(fmt::format("The tracker knows this wand without being told: tags {} to {} of tag36h11. Every wand in a room",
                    kPanels * number, kPanels * number + kPanels - 1));
  write(fmt::format("needs a number of its own: cyclorama wand --print FILE --number N, 0 to {}.", kStandardWands - 1));
  if (paper.card_scale != 1.0) {
    write("This one is larger than the standard: cyclorama wand --describe FILE, cyclorama-tracker --wand FILE.");
  }
  draw_folded(card, 0.5 / paper.card_scale, {0.5 * paper.width_mm, y + 12.0}, &page);
  return page;
}

}  // namespace

const std::vector<Paper>& papers() {
  static const std::vector<Paper> list{
      {"a4", 297.0, 210.0, 1.0}, {"letter", 279.4, 215.9, 1.0}, {"a3", 420.0, 297.0, std::sqrt(2.0)}};
  return list;
}

FoldedCard card_on(const Paper& paper) { return FoldedCard().scaled(paper.card_scale); }

std::vector<VectorPage> wand_sheet(int number, const Paper& paper) {
  const FoldedCard card = card_on(paper);
  CHECK(3e3 * card.panel_width_m <= paper.width_mm);
  CHECK(1e3 * (card.panel_height_m + 2.0 * card.lid_depth_m()) <= paper.height_mm);
  VectorPage sheet(paper.width_mm, paper.height_mm);
  CardDrawing drawing(card, &sheet);
  for (int panel = 0; panel < kPanels; ++panel) {
    drawing.draw_tag(kPanels * number + panel, (panel - 1) * drawing.panel_mm());
  }
  drawing.draw_lines();
  drawing.draw_scale();
  drawing.write(-6.0, drawing.top_mm() + 30.0, 6.0, "TOP");
  drawing.write(-1.5 * drawing.panel_mm(), drawing.top_mm() + 4.0, 4.0, fmt::format("wand {}", number));
  VectorPage back(paper.width_mm, paper.height_mm);
  CardDrawing of_back(card, &back);
  of_back.draw_tag(kBackTag, 0.0);
  of_back.write(-20.0, -0.5 * drawing.panel_mm() - 8.0, 4.0, "back: the next language");
  of_back.draw_panel();
  return {sheet, instructions(number, paper), back};
}

}  // namespace cyclorama::operations
