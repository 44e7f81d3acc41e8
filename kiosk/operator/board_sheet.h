// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/board/tag_board.h"
#include "kiosk/operator/vector_page.h"
#include "kiosk/operator/wand_sheet.h"

namespace cyclorama {

/// The board that a sheet of this paper gives.
[[nodiscard]] TagBoard board_on(const Paper& paper);

/// The board to print, and a page that says how to photograph it.
[[nodiscard]] std::vector<VectorPage> board_sheet(const Paper& paper);

}  // namespace cyclorama
