// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "kiosk/care/alarm_outbox.h"
#include "kiosk/care/alarm_registry.h"
#include "kiosk/care/care_settings.h"
#include "kiosk/operator/checks.h"
#include "kiosk/operator/museum_state.h"

namespace cyclorama::operations {

/// Sends the museum's alarms: looks at the checks every five seconds, and delivers what is due by mail and webhook
/// (kiosk/care). Thread-safe. Threads: one, "alarms", which blocks while it sends, for at most a minute.
class AlarmService {
 public:
  struct Options {
    MuseumState museum;
    std::filesystem::path keep;                  ///< Folder in which the state outlives restarts.
    std::function<std::vector<Check>()> checks;  ///< The present checks; the service's thread calls it.
    std::function<std::string()> page;           ///< Address of the operator page; empty: unknown.
  };
  /// State for the page. A value.
  struct Report {
    bool has_mail = false;
    bool has_webhook = false;
    std::string quiet;         ///< "22:00-07:00"; empty: none.
    std::string delivered_at;  ///< Time of the last delivery since the start (ISO 8601); empty: none.
    std::string problem;       ///< Reason why the last try failed; empty: none.
  };

  explicit AlarmService(Options options);
  ~AlarmService();
  AlarmService(const AlarmService&) = delete;
  AlarmService& operator=(const AlarmService&) = delete;

  [[nodiscard]] Report report() const;
  /// The alarms as a check of their own; nothing if nobody is to get any.
  [[nodiscard]] std::optional<Check> check() const;
  /// Sends a test to every receiver at once. Blocks for at most two minutes. Errors: kNotFound if there is none; those of
  /// send_mail() and send_webhook().
  Status send_test() const;

 private:
  void run();
  void look(care::WallSeconds now);
  void deliver(const care::CareSettings& settings, care::WallSeconds now);
  [[nodiscard]] Status send(care::AlarmChannel channel, const care::CareSettings& settings,
                            const std::vector<care::Alarm>& alarms) const;
  void read_state();
  void write_state() const;

  const Options options_;
  care::AlarmRegistry registry_;  // This and the next are the thread's alone.
  care::AlarmOutbox outbox_;
  mutable std::mutex mutex_;  ///< Guards the following.
  std::condition_variable changed_;
  bool is_stopping_ = false;
  Report report_;
  std::thread thread_;
};

}  // namespace cyclorama::operations
