// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/wire/inspection.pb.h"

namespace cyclorama::watch {

/// Returns the farm as a table for a terminal: its state, sessions, nodes and the stages of a frame. Lines have at most
/// `columns` characters, however long a museum's name is. Pure.
[[nodiscard]] std::string top_text(const wire::ProcessStatus& status, int columns);

}  // namespace cyclorama::watch
