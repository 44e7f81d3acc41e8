// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/wire/inspection.pb.h"

namespace cyclorama::watch {

/// Returns JSON:
///
///   { process, version, uptime_s, state, healthy, gauges: {}, facts: {},
///     stages: { name: { count, p50_ms, p95_ms, p99_ms } },
///     and for each table, by its name, its rows: [ { column: value } ] }
///
/// Values that are unknown or not finite are null.
[[nodiscard]] std::string status_json(const wire::ProcessStatus& status);
/// Returns one table of the status as a list; empty if there is no table of that name.
[[nodiscard]] std::string table_json(const wire::ProcessStatus& status, const std::string& table);

}  // namespace cyclorama::watch
