// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kiosk/operator/museum_state.h"
#include "kiosk/operator/setup_routes.h"
#include "kiosk/operator/vector_page.h"

namespace cyclorama::operations {

/// Returns the sheet for the folder in the museum's office: how the page is reached, what is installed, and lines for
/// what must not be printed (PIN, recovery key). Settings that cannot be read are left out.
[[nodiscard]] VectorPage setup_sheet(const MuseumState& museum, const SheetFacts& facts);

}  // namespace cyclorama::operations
