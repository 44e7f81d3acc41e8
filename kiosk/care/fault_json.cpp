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

nlohmann::ordered_json alarm_json(const Alarm& alarm) {
  nlohmann::ordered_json json = to_json(alarm.fault);
  json["since_s"] = to_number(alarm.since);
  json["at_s"] = to_number(alarm.at);
  json["is_over"] = alarm.is_over;
  return json;
}

Alarm read_alarm(StrictJson& json) {
  Alarm alarm;
  alarm.fault = read_fault(json);
  alarm.since = read_time(json, "since_s");
  alarm.at = read_time(json, "at_s");
  alarm.is_over = json.flag("is_over");
  json.refuse_other_keys();
  return alarm;
}

}  // namespace cyclorama::care
