// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "kiosk/care/fault_history.h"
#include "kiosk/care/visit_counts.h"
#include "kiosk/operator/checks.h"
#include "kiosk/operator/museum_state.h"
#include "kiosk/operator/watch.h"

namespace cyclorama::operations {

/// Records the museum's last faults, and how many visitors there were and for how long (kiosk/care): looks every five
/// seconds. Thread-safe. Threads: one, which writes files.
class CareLog {
 public:
  struct Options {
    MuseumState museum;
    std::filesystem::path keep;  ///< Folder in which the records outlive restarts.
    const Watch* watch = nullptr;
    std::function<std::vector<Check>()> checks;  ///< The present checks; the log's thread calls it.
  };
  /// State for the page. A value.
  struct Report {
    std::vector<care::Alarm> events;  ///< The newest is the last.
    std::map<std::string, care::VisitCounts::Day> days;
    care::VisitCounts::Day total;
    std::string today;  ///< The museum's date.
    bool is_visited = false;
  };

  explicit CareLog(Options options);
  ~CareLog();
  CareLog(const CareLog&) = delete;
  CareLog& operator=(const CareLog&) = delete;

  [[nodiscard]] Report report() const;

 private:
  void run();
  void look(care::WallSeconds now);
  void write(const char* name, const std::string& text) const;
  [[nodiscard]] std::string today(care::WallSeconds now) const;

  const Options options_;
  care::FaultHistory history_;  // This and the next are the thread's alone.
  care::VisitCounts visits_;
  mutable std::mutex mutex_;  ///< Guards the following.
  std::condition_variable changed_;
  bool is_stopping_ = false;
  Report report_;
  std::thread thread_;
};

}  // namespace cyclorama::operations
