// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "common/base/unique_fd.h"
#include "common/wire/identity.h"

namespace cyclorama::trust {

/// Statistics of a session.
struct SessionSummary {
  double seconds = 0.0;
  std::uint64_t frames = 0;  ///< Complete frames that the museum received.
  std::uint64_t bytes = 0;   ///< Bytes of the tiles that the museum received.
};

/// One line of the log. Empty fields are omitted.
struct AuditEvent {
  std::string event{};  ///< "session opened", "session refused", "session ended", "node came", "grants read" ...
  Identity who{};
  std::string scene{};
  std::string reason{};
  std::optional<SessionSummary> session{};
};

/// A log of sessions, nodes and refusals: a file of JSON lines in chronological order:
///
///   {"time":"2026-11-22T01:02:03.456Z","event":"session ended","role":"museum","name":"hall-3","serial":"4C97...",
///    "address":"ipv6:[::1]:40112","scene":"grotto","seconds":12.5,"frames":240,"bytes":151000000}
///
/// Each line is written with one call to a file opened for appending, so neither a crash of the coordinator nor a full
/// disk leaves a partial line. If the file was moved away (logrotate), the next line begins a new file. A file that
/// would exceed its limit is renamed to PATH.1, replacing the previous PATH.1, so the two take at most twice the limit.
/// Lines survive a power cut after about a second: the thread `audit` calls fdatasync at most twice a second, so that
/// writers need not wait for the disk. Thread-safe.
class AuditLog {
 public:
  /// About 200 000 lines.
  static constexpr std::uint64_t kMaxBytes = std::uint64_t{64} << 20;

  /// Opens the log. Errors: kNotFound or kSystem if the file cannot be opened.
  static Result<std::unique_ptr<AuditLog>> open(std::filesystem::path path, std::uint64_t max_bytes = kMaxBytes);
  /// Waits until the lines are on the disk.
  ~AuditLog();
  AuditLog(const AuditLog&) = delete;
  AuditLog& operator=(const AuditLog&) = delete;

  /// Writes a line. Errors: kSystem if the line is lost, for example because the disk is full. Also kSystem if the line
  /// was written, but earlier lines were not made durable or PATH could not be renamed.
  Status write(const AuditEvent& event);
  /// Waits until all lines so far are durable. Returns false at the deadline.
  bool wait_for_disk(Duration limit);

 private:
  using File = std::shared_ptr<const UniqueFd>;
  AuditLog(std::filesystem::path path, std::uint64_t max_bytes);
  Status open_file();
  [[nodiscard]] bool was_moved() const;
  Status make_room(std::uint64_t bytes);
  Status append(const std::string& line);
  void run();

  const std::filesystem::path path_;
  const std::uint64_t max_bytes_;
  std::mutex mutex_;  ///< Guards the following.
  std::condition_variable changed_;
  File file_;  ///< Null if no file could be opened.
  std::vector<File> unsynced_;
  bool is_syncing_ = false;
  Status synced_ = Done{};  ///< Outcome of the last fdatasync. A failure is reported with the next line.
  bool stopping_ = false;
  std::thread thread_;  ///< Last member, because the thread uses all others.
};

}  // namespace cyclorama::trust
