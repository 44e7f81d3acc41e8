// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "kiosk/care/alarm_registry.h"

namespace cyclorama::care {

enum class AlarmChannel { kMail, kWebhook };
inline constexpr std::array kAlarmChannels{AlarmChannel::kMail, AlarmChannel::kWebhook};

/// Alarms that are not delivered yet, apart for each channel: a mail server that is away delays no webhook. Each channel
/// is tried again after a minute, then after twice as long, up to an hour. Beyond kMaxWaiting the oldest is dropped. Pure;
/// its state outlives restarts as JSON. Thread-bound.
class AlarmOutbox {
 public:
  static constexpr std::size_t kMaxWaiting = 100;

  void add(AlarmChannel channel, std::span<const Alarm> alarms);
  /// Returns what is to be sent now, as one message; empty: nothing, or the last try was not long enough ago.
  [[nodiscard]] std::vector<Alarm> due(AlarmChannel channel, WallSeconds now) const;
  /// Removes the first `count` alarms, which were sent.
  void sent(AlarmChannel channel, std::size_t count);
  void failed(AlarmChannel channel, WallSeconds now);
  /// Removes what waits for a channel that has no receiver any more.
  void clear(AlarmChannel channel);

  [[nodiscard]] std::string to_json() const;
  /// Replaces the state. Errors: kBadData with position and mistake; the state is then as before.
  Status read_json(std::string_view text, const std::string& name);

 private:
  struct Queue {
    std::vector<Alarm> waiting;
    int failures = 0;
    WallSeconds failed_at{};
  };
  [[nodiscard]] const Queue& of(AlarmChannel channel) const { return queues_[static_cast<std::size_t>(channel)]; }
  [[nodiscard]] Queue& of(AlarmChannel channel) { return queues_[static_cast<std::size_t>(channel)]; }

  std::array<Queue, kAlarmChannels.size()> queues_;
};

}  // namespace cyclorama::care
