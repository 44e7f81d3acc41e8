// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/trust/audit_log.h"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/base/text.h"

namespace cyclorama {
namespace {

constexpr std::size_t kLongestText = 500;

std::string time_text() {
  const auto now = std::chrono::system_clock::now();
  const auto seconds = std::chrono::floor<std::chrono::seconds>(now);
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(now - seconds).count();
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z", fmt::gmtime(std::chrono::system_clock::to_time_t(now)), ms);
}

std::string line_of(const AuditEvent& event) {
  nlohmann::ordered_json line;
  const auto add = [&](const char* key, std::string_view text) {
    if (!text.empty()) line[key] = printable(text, kLongestText);
  };
  add("time", time_text());
  add("event", event.event);
  if (event.who.role != Role::kNobody) add("role", to_text(event.who.role));
  add("name", event.who.name);
  add("serial", event.who.serial);
  add("address", event.who.address);
  add("scene", event.scene);
  add("reason", event.reason);
  if (event.visit) {
    line["seconds"] = std::round(1000.0 * event.visit->seconds) / 1000.0;
    line["frames"] = event.visit->frames;
    line["bytes"] = event.visit->bytes;
  }
  return line.dump() + "\n";
}

}  // namespace

Result<std::unique_ptr<AuditLog>> AuditLog::open(std::filesystem::path path) {
  std::unique_ptr<AuditLog> log(new AuditLog(std::move(path)));
  TRY(log->open_file());
  return log;
}

Status AuditLog::open_file() {
  file_ = UniqueFd(::open(path_.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0640));
  if (!file_.is_open()) return Error::from_errno(fmt::format("opening the audit log '{}'", path_.string()));
  return Done{};
}

bool AuditLog::was_moved() const {
  struct ::stat named {};
  struct ::stat open {};
  return ::stat(path_.c_str(), &named) != 0 || ::fstat(file_.get(), &open) != 0 || named.st_ino != open.st_ino ||
         named.st_dev != open.st_dev;
}

Status AuditLog::write(const AuditEvent& event) {
  const std::string line = line_of(event);
  const std::lock_guard lock(mutex_);
  if (!file_.is_open() || was_moved()) {
    TRY(open_file());
  }
  const ssize_t written = ::write(file_.get(), line.data(), line.size());
  if (written != static_cast<ssize_t>(line.size())) {
    return Error::from_errno(fmt::format("writing the audit log '{}'", path_.string()));
  }
  return Done{};
}

}  // namespace cyclorama
