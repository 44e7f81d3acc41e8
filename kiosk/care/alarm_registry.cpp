// SPDX-License-Identifier: Apache-2.0
#include "kiosk/care/alarm_registry.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "common/json/strict_json.h"
#include "kiosk/care/fault_json.h"

namespace cyclorama::care {
namespace {

constexpr int kRegistryVersion = 1;
constexpr std::size_t kMaxKnown = 500;
}  // namespace

std::vector<Alarm> AlarmRegistry::update(const std::vector<Fault>& present, const AlarmRules& rules, WallSeconds now) {
  std::vector<Alarm> due;
  std::set<std::string> ids;
  for (const Fault& fault : present) {
    if (!ids.insert(fault.id).second || (known_.size() >= kMaxKnown && !known_.contains(fault.id))) continue;
    const auto [at, is_new] = known_.try_emplace(fault.id, Known{fault, now, now});
    Known& known = at->second;
    known.fault = fault;
    known.seen = now;
    known.since = std::min(known.since, now);
    if (known.is_reported || rules.is_quiet || now - known.since < rules.after) continue;
    known.is_reported = true;
    due.push_back({fault, known.since, now, false});
  }
  for (auto at = known_.begin(); at != known_.end();) {
    Known& known = at->second;
    known.seen = std::min(known.seen, now);
    if (ids.contains(at->first) || now - known.seen < rules.after || (known.is_reported && rules.is_quiet)) {
      ++at;
      continue;
    }
    if (known.is_reported) due.push_back({known.fault, known.since, now, true});
    at = known_.erase(at);
  }
  return due;
}

std::string AlarmRegistry::to_json() const {
  nlohmann::ordered_json faults = nlohmann::ordered_json::array();
  for (const auto& [id, known] : known_) {
    nlohmann::ordered_json fault = care::to_json(known.fault);
    fault["since_s"] = to_number(known.since);
    fault["seen_s"] = to_number(known.seen);
    fault["is_reported"] = known.is_reported;
    faults.push_back(std::move(fault));
  }
  return nlohmann::ordered_json{{"version", kRegistryVersion}, {"faults", std::move(faults)}}.dump(
             1, ' ', false, nlohmann::json::error_handler_t::replace) +
         "\n";
}

Status AlarmRegistry::read_json(std::string_view text, const std::string& name) {
  constexpr const char* kRemedy = "remove it; alarms of faults that last are then sent again";
  TRY_ASSIGN(const nlohmann::json document, parse_document(text, name, kRemedy));
  StrictJson::Mistakes mistakes(kRemedy);
  StrictJson root(document, &mistakes);
  root.require_version(kRegistryVersion);
  std::map<std::string, Known> known;
  for (StrictJson& one : root.list("faults", 0, kMaxKnown)) {
    Known fault;
    fault.fault = read_fault(one);
    fault.since = read_time(one, "since_s");
    fault.seen = read_time(one, "seen_s");
    fault.is_reported = one.flag("is_reported");
    one.refuse_other_keys();
    known[fault.fault.id] = std::move(fault);
  }
  root.refuse_other_keys();
  TRY(mistakes.status(name));
  known_ = std::move(known);
  return Done{};
}

}  // namespace cyclorama::care
