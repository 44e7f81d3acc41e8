// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/board/tag_board.h"
#include "kiosk/operator/vector_page.h"
#include "kiosk/operator/wand_sheet.h"

namespace cyclorama::operations {

/// Returns the board, scaled to fit a sheet of this paper.
[[nodiscard]] TagBoard board_on(const Paper& paper);

/// Returns the board to print, and a page of instructions for photographing it.
[[nodiscard]] std::vector<VectorPage> board_sheet(const Paper& paper);

}  // namespace cyclorama::operations
