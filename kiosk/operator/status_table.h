// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kiosk/operator/observation.h"
#include "kiosk/operator/summary.h"

namespace cyclorama::operations {

/// Returns a table for a terminal: each part with its state, then the stages from shutter to photon.
[[nodiscard]] std::string status_table(const std::vector<ProcessObservation>& observations);

/// Returns the same table at the end of a recording, with its frame rate.
[[nodiscard]] std::string status_table_of(const Recording& recording, const RecordedSpan& span);

}  // namespace cyclorama::operations
