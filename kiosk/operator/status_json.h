// SPDX-License-Identifier: Apache-2.0
/// JSON for pages and scripts, written and parsed.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "common/wire/museum.pb.h"
#include "kiosk/operator/observation.h"

namespace cyclorama::operations {

/// { "processes": [ { name, address, away, healthy, state, version, uptime_s, gauges: {}, facts: {}, pictures: [],
///                    stages: [ { name, count, p50_ms, p95_ms, p99_ms } ] } ],
///   "flow": [ { name, where, inside, count, p50_ms, p95_ms, p99_ms } ],  in frame order, from the tour
///   "well": true when every process is }
/// A value that is not finite is null.
[[nodiscard]] std::string status_json(const std::vector<ProcessObservation>& observations);

/// Parses { "forward": 0..., "right": 0..., "turn": 0... }; an absent key counts as 0. Errors: kBadData, with the key,
/// for other JSON, another key, or a number beyond [-1, 1].
Result<wire::SteerRequest> parse_steer(std::string_view json);

}  // namespace cyclorama::operations
