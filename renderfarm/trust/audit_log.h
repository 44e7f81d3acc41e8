// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "common/base/result.h"
#include "common/base/unique_fd.h"
#include "common/wire/identity.h"

namespace cyclorama {

/// How a visit went.
struct VisitSummary {
  double seconds = 0.0;
  std::uint64_t frames = 0;  ///< Complete ones that the museum took.
  std::uint64_t bytes = 0;   ///< Of tiles that it took.
};

/// One line of the log. Empty texts are left out.
struct AuditEvent {
  std::string event{};  ///< "visit opened", "visit refused", "visit ended", "node came", "grants read" ...
  Identity who{};
  std::string scene{};
  std::string reason{};
  std::optional<VisitSummary> visit{};
};

/// Who came, saw, was refused or left: a file of JSON lines that only grows, in the order of things:
///
///   {"time":"2026-11-22T01:02:03.456Z","event":"visit ended","role":"museum","name":"hall-3","serial":"4C97...",
///    "address":"ipv6:[::1]:40112","scene":"grotto","seconds":12.5,"frames":240,"bytes":151000000}
///
/// Each line is one write to a file opened for appending, so that no crash of the head leaves half a line. When the
/// file was moved away (logrotate), the next line begins a new one. Thread-safe.
class AuditLog {
 public:
  /// kNotFound, kSystem  it cannot be opened.
  static Result<std::unique_ptr<AuditLog>> open(std::filesystem::path path);
  /// kSystem  the disk is full, say.
  Status write(const AuditEvent& event);

 private:
  explicit AuditLog(std::filesystem::path path) : path_(std::move(path)) {}
  Status open_file();
  [[nodiscard]] bool was_moved() const;

  const std::filesystem::path path_;
  std::mutex mutex_;  ///< Guards the following.
  UniqueFd file_;
};

}  // namespace cyclorama
