// SPDX-License-Identifier: Apache-2.0
#include "kiosk/care/fault_history.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "common/json/strict_json.h"
#include "kiosk/care/fault_json.h"

namespace cyclorama::care {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kHistoryVersion = 1;
/// A condition that lasts less is no event.
constexpr AlarmRules kLasting{std::chrono::seconds(30), false};

}  // namespace

bool FaultHistory::update(const std::vector<Fault>& present, WallSeconds now) {
  const std::vector<Alarm> due = known_.update(present, kLasting, now);
  events_.insert(events_.end(), due.begin(), due.end());
  while (events_.size() > kMaxEvents) events_.pop_front();
  return !due.empty();
}

std::string FaultHistory::to_json() const {
  Json events = Json::array();
  for (const Alarm& event : events_) events.push_back(alarm_json(event));
  return Json{{"version", kHistoryVersion}, {"known", Json::parse(known_.to_json())}, {"events", std::move(events)}}
             .dump(1, ' ', false, Json::error_handler_t::replace) +
         "\n";
}

Status FaultHistory::read_json(std::string_view text, const std::string& name) {
  constexpr const char* kRemedy = "remove it; the history then begins anew";
  TRY_ASSIGN(const nlohmann::json document, parse_document(text, name, kRemedy));
  StrictJson::Mistakes mistakes(kRemedy);
  StrictJson root(document, &mistakes);
  root.require_version(kHistoryVersion);
  root.at("known");
  std::deque<Alarm> events;
  for (StrictJson& one : root.list("events", 0, kMaxEvents)) events.push_back(read_alarm(one));
  root.refuse_other_keys();
  TRY(mistakes.status(name));
  AlarmRegistry known;
  TRY(known.read_json(document["known"].dump(), name));
  known_ = std::move(known);
  events_ = std::move(events);
  return Done{};
}

}  // namespace cyclorama::care
