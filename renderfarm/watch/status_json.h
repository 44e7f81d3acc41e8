// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/wire/inspection.pb.h"

namespace cyclorama {

/// { process, version, uptime_s, state, healthy, gauges: {}, facts: {}, stages: { name: { count, p50_ms, p95_ms, p99_ms
/// } },
///   and under the name of each table, its rows: [ { column: value } ] }
/// A value that is not known or not finite is null.
[[nodiscard]] std::string status_json(const wire::ProcessStatus& status);
/// One table of it, as a list; empty when there is none of that name.
[[nodiscard]] std::string table_json(const wire::ProcessStatus& status, const std::string& table);

}  // namespace cyclorama
