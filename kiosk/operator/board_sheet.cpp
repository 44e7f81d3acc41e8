// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/board_sheet.h"

#include <fmt/format.h>

#include "common/base/check.h"
#include "common/wand/tag_bitmap.h"

namespace cyclorama::operations {
namespace {

constexpr double kBorder_mm = 6.0;  // White border of the board, which the tags at its edges need.

VectorPage drawing(const TagBoard& board, const Paper& paper) {
  VectorPage page(paper.width_mm, paper.height_mm);
  const double square = 1e3 * board.square_m;
  const double left = 0.5 * (paper.width_mm - board.columns * square);
  const double top = 0.5 * (paper.height_mm - board.rows * square);
  CHECK(left >= kBorder_mm && top >= kBorder_mm);
  std::vector<std::pair<PagePoint, PagePoint>> black;
  for (int y = 0; y < board.rows; ++y) {
    for (int x = 0; x < board.columns; ++x) {
      if (!TagBoard::is_black(x, y)) continue;
      black.emplace_back(PagePoint{left + x * square, top + y * square},
                         PagePoint{left + (x + 1) * square, top + (y + 1) * square});
    }
  }
  for (int tag = board.first_tag; tag < board.first_tag + board.tags(); ++tag) {
    const auto corners = board.tag_corners_m(tag);
    CHECK(corners.has_value());
    const TagBitmap bitmap = tag_bitmap(tag);
    const double cell = 1e3 * board.tag_m * bitmap.width_in_tags / bitmap.cells;
    // The board's origin is its first corner; the bitmap's is the corner of its white border.
    const Eigen::Vector2d middle = 1e3 * 0.5 * ((*corners)[0] + (*corners)[2]);
    const double u = left + square + middle.x() - 0.5 * cell * bitmap.cells;
    const double v = top + square + middle.y() - 0.5 * cell * bitmap.cells;
    for (int y = 0; y < bitmap.cells; ++y) {
      for (int x = 0; x < bitmap.cells; ++x) {
        if (bitmap.is_white(x, y)) continue;
        black.emplace_back(PagePoint{u + x * cell, v + y * cell}, PagePoint{u + (x + 1) * cell, v + (y + 1) * cell});
      }
    }
  }
  page.fill(black, 0.0);
  return page;
}

VectorPage instructions(const TagBoard& board, const Paper& paper) {
  VectorPage page(paper.width_mm, paper.height_mm);
  double y = 22.0;
  const auto write = [&](const std::string& words) {
    page.text({20.0, y}, 6.5, words);
    y += 7.5;
  };
  page.text({20.0, y}, 11.0, "Cyclorama: the board for a camera's lens");
  y += 13.0;
  write("1. Print the other page at 100 %: not \"fit to page\". Glue it onto something flat: glass, or a stiff board.");
  write(fmt::format("2. Measure five squares with a ruler: they should be {:.1f} mm. If not, tell the fifth part",
                    5e3 * board.square_m));
  write("   with --square-mm; the lens itself does not depend on it.");
  write("3. Fix the camera's focus and zoom as they will be used. Light the board evenly, without gloss.");
  write("4. Take about 20 pictures, the board still in each: in the middle and in all corners of the picture, near");
  write("   enough to fill a third of it, and in most of them turned by 20 to 45 degrees, each time another way.");
  write("   A part of the board is enough: let it reach over the picture's rim.");
  write("5. cyclorama calibrate-camera --pictures FOLDER --out camera.json");
  write("   or, with the camera plugged in: cyclorama calibrate-camera --camera v4l2: --out camera.json");
  write("6. cyclorama-tracker reads it: lens = \"camera.json\" under [camera].");
  if (paper.card_scale != 1.0) write(fmt::format("   This board needs --square-mm {:.2f}.", 1e3 * board.square_m));
  return page;
}

}  // namespace

TagBoard board_on(const Paper& paper) { return TagBoard().scaled(paper.card_scale); }

std::vector<VectorPage> board_sheet(const Paper& paper) {
  const TagBoard board = board_on(paper);
  return {drawing(board, paper), instructions(board, paper)};
}

}  // namespace cyclorama::operations
