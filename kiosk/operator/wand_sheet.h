// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/wand/folded_card.h"
#include "kiosk/operator/vector_page.h"

namespace cyclorama::operations {

/// A paper size in landscape, and the scale of the card that fits on it relative to FoldedCard's default.
struct Paper {
  std::string_view name;
  double width_mm;
  double height_mm;
  double card_scale;
};
[[nodiscard]] const std::vector<Paper>& papers();

/// Returns the sheet to print, cut and fold, a page of instructions, and the tag for the back. Preconditions: those of standard_wand(); the
/// card fits on the paper.
[[nodiscard]] std::vector<VectorPage> wand_sheet(int number, const Paper& paper);

/// Returns the card that can be made from a sheet of this paper.
[[nodiscard]] FoldedCard card_on(const Paper& paper);

}  // namespace cyclorama::operations
