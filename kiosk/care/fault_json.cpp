// SPDX-License-Identifier: Apache-2.0
#include "kiosk/care/fault_json.h"

namespace cyclorama::care {
namespace {
constexpr std::size_t kMaxText = 4000;
constexpr double kMaxTime_s = 1e11;
}  // namespace

nlohmann::ordered_json to_json(const Fault& fault) {
  return {{"id", fault.id}, {"title", fault.title}, {"sentence", fault.sentence}, {"remedy", fault.remedy}};
}

std::int64_t to_number(WallSeconds time) { return time.time_since_epoch().count(); }

Fault read_fault(StrictJson& json) {
  return {json.text("id", kMaxText), json.text("title", kMaxText), json.text("sentence", kMaxText),
          json.text("remedy", kMaxText)};
}

WallSeconds read_time(StrictJson& json, const char* key) {
  return WallSeconds(std::chrono::seconds(static_cast<std::int64_t>(json.number(key, -kMaxTime_s, kMaxTime_s))));
}

}  // namespace cyclorama::care
