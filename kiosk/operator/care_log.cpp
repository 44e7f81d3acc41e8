// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/care_log.h"

#include <absl/time/time.h>

#include <algorithm>
#include <utility>

#include "common/base/file.h"
#include "common/opening/opening_hours.h"
#include "common/process/log.h"
#include "kiosk/operator/observation.h"

namespace cyclorama::operations {
namespace {

constexpr auto kBetweenRecords = std::chrono::seconds(5);
constexpr std::size_t kMaxRecordBytes = 1 << 20;
constexpr const char* kHistoryFile = "history.json";
constexpr const char* kVisitsFile = "visits.json";

/// True while a visitor steers: neither the guide nor nobody.
bool is_steered(const std::vector<ProcessObservation>& processes) {
  return std::ranges::any_of(processes, [](const ProcessObservation& process) {
    if (process.endpoint.name != "tour" || process.away || !process.status) return false;
    const std::string by = fact_of(*process.status, "steered_by");
    return !by.empty() && by != "guide" && by != "nobody";
  });
}

}  // namespace

CareLog::CareLog(Options options) : options_(std::move(options)) {
  const auto take = [](const Status& read) {
    if (!read) log(LogLevel::kWarning, read.error().message() + ", ignoring");
  };
  if (const auto text = read_text_file(options_.keep / kHistoryFile, kMaxRecordBytes))
    take(history_.read_json(*text, kHistoryFile));
  if (const auto text = read_text_file(options_.keep / kVisitsFile, kMaxRecordBytes))
    take(visits_.read_json(*text, kVisitsFile));
  thread_ = std::thread([this] { run(); });
}

CareLog::~CareLog() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void CareLog::run() {
  for (;;) {
    look(std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now()));
    std::unique_lock lock(mutex_);
    if (changed_.wait_for(lock, kBetweenRecords, [this] { return is_stopping_; })) return;
  }
}

std::string CareLog::today(care::WallSeconds now) const {
  const auto hours = read_opening_hours(options_.museum.site());
  return absl::FormatTime("%E4Y-%m-%d", absl::FromChrono(now), hours ? hours->zone() : absl::LocalTimeZone());
}

void CareLog::look(care::WallSeconds now) {
  if (!is_clock_set(now)) return;
  std::vector<care::Fault> faults;
  for (const Check& check : options_.checks()) {
    if (check.level != CheckLevel::kOk) faults.push_back({check.id, check.title, check.sentence, check.remedy});
  }
  if (history_.update(faults, now)) write(kHistoryFile, history_.to_json());
  const std::string day = today(now);
  const int before = visits_.total().visits;
  visits_.update(is_steered(options_.watch->observations()), now, day);
  if (visits_.total().visits != before) write(kVisitsFile, visits_.to_json());
  const std::lock_guard lock(mutex_);
  report_ = {
      {history_.events().begin(), history_.events().end()}, visits_.days(), visits_.total(), day, visits_.is_visited()};
}

void CareLog::write(const char* name, const std::string& text) const {
  const Status written = write_file_atomically(options_.keep / name, std::string_view(text));
  if (!written) log(LogLevel::kError, written.error().message());
}

CareLog::Report CareLog::report() const {
  const std::lock_guard lock(mutex_);
  return report_;
}

}  // namespace cyclorama::operations
