// SPDX-License-Identifier: Apache-2.0
#include "kiosk/care/alarm_outbox.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/json/strict_json.h"
#include "kiosk/care/fault_json.h"

namespace cyclorama::care {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kOutboxVersion = 1;
constexpr std::array<const char*, kAlarmChannels.size()> kNames{"mail", "webhook"};
constexpr std::chrono::seconds kFirstWait{60};
constexpr std::chrono::seconds kMaxWait{3600};
constexpr int kMaxDoublings = 6;
}  // namespace

void AlarmOutbox::add(AlarmChannel channel, std::span<const Alarm> alarms) {
  std::vector<Alarm>& waiting = of(channel).waiting;
  waiting.insert(waiting.end(), alarms.begin(), alarms.end());
  if (waiting.size() > kMaxWaiting) waiting.erase(waiting.begin(), waiting.end() - kMaxWaiting);
}

std::vector<Alarm> AlarmOutbox::due(AlarmChannel channel, WallSeconds now) const {
  const Queue& queue = of(channel);
  if (queue.failures == 0) return queue.waiting;
  const auto wait = std::min(kFirstWait * (1 << std::min(queue.failures - 1, kMaxDoublings)), kMaxWait);
  // A clock that was set back must not delay alarms for years.
  const bool is_waiting = now >= queue.failed_at && now - queue.failed_at < wait;
  return is_waiting ? std::vector<Alarm>{} : queue.waiting;
}

void AlarmOutbox::sent(AlarmChannel channel, std::size_t count) {
  Queue& queue = of(channel);
  const auto end = queue.waiting.begin() + static_cast<std::ptrdiff_t>(std::min(count, queue.waiting.size()));
  queue.waiting.erase(queue.waiting.begin(), end);
  queue.failures = 0;
}

void AlarmOutbox::failed(AlarmChannel channel, WallSeconds now) {
  of(channel).failed_at = now;
  of(channel).failures = std::min(of(channel).failures + 1, kMaxDoublings + 1);
}

void AlarmOutbox::clear(AlarmChannel channel) { of(channel) = Queue{}; }

std::string AlarmOutbox::to_json() const {
  Json json{{"version", kOutboxVersion}};
  for (const AlarmChannel channel : kAlarmChannels) {
    Json list = Json::array();
    for (const Alarm& alarm : of(channel).waiting) list.push_back(alarm_json(alarm));
    json[kNames[static_cast<std::size_t>(channel)]] = std::move(list);
  }
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Status AlarmOutbox::read_json(std::string_view text, const std::string& name) {
  constexpr const char* kRemedy = "remove it; alarms that were not sent yet are lost";
  TRY_ASSIGN(const nlohmann::json document, parse_document(text, name, kRemedy));
  StrictJson::Mistakes mistakes(kRemedy);
  StrictJson root(document, &mistakes);
  root.require_version(kOutboxVersion);
  std::array<Queue, kAlarmChannels.size()> queues;
  for (std::size_t i = 0; i < queues.size(); ++i) {
    for (StrictJson& one : root.list(kNames[i], 0, kMaxWaiting)) queues[i].waiting.push_back(read_alarm(one));
  }
  root.refuse_other_keys();
  TRY(mistakes.status(name));
  queues_ = std::move(queues);
  return Done{};
}

}  // namespace cyclorama::care
