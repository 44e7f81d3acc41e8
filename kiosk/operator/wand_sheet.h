// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/wand/folded_card.h"
#include "kiosk/operator/vector_page.h"

namespace cyclorama {

/// A size of paper, held broad, and how much larger than FoldedCard's default the card on it is.
struct Paper {
  std::string_view name;
  double width_mm;
  double height_mm;
  double card_scale;
};
[[nodiscard]] const std::vector<Paper>& papers();

/// The sheet to print, cut and fold, and a page that says how. Preconditions: as standard_wand(); the card fits.
[[nodiscard]] std::vector<VectorPage> wand_sheet(int number, const Paper& paper);

/// The card that a sheet of this paper gives.
[[nodiscard]] FoldedCard card_on(const Paper& paper);

}  // namespace cyclorama
