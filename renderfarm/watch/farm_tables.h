// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/wire/inspection.pb.h"
#include "renderfarm/watch/farm_overview.h"

namespace cyclorama::watch {

/// Return the tables "sessions" and "nodes" of the inspection service. `cyclorama-farm top` and the page show them.
[[nodiscard]] wire::Table sessions_table(const FarmOverview& farm);
[[nodiscard]] wire::Table nodes_table(const FarmOverview& farm);

}  // namespace cyclorama::watch
