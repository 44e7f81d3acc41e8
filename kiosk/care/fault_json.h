// SPDX-License-Identifier: Apache-2.0
/// Faults and times in the files of this folder. Internal.
#pragma once

#include <nlohmann/json.hpp>

#include "common/json/strict_json.h"
#include "kiosk/care/alarm_registry.h"

namespace cyclorama::care {

[[nodiscard]] nlohmann::ordered_json to_json(const Fault& fault);
[[nodiscard]] std::int64_t to_number(WallSeconds time);
Fault read_fault(StrictJson& json);
WallSeconds read_time(StrictJson& json, const char* key);
[[nodiscard]] nlohmann::ordered_json alarm_json(const Alarm& alarm);
/// Reads an alarm, which has no other keys.
Alarm read_alarm(StrictJson& json);

}  // namespace cyclorama::care
