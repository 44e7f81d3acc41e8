// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/trust/audit_log.h"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/base/text.h"

namespace cyclorama::trust {
namespace {

constexpr std::size_t kMaxTextBytes = 500;
constexpr Duration kSyncEvery = std::chrono::milliseconds(500);

std::string time_text() {
  const auto now = std::chrono::system_clock::now();
  const auto seconds = std::chrono::floor<std::chrono::seconds>(now);
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(now - seconds).count();
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z", fmt::gmtime(std::chrono::system_clock::to_time_t(now)), ms);
}

std::string line_of(const AuditEvent& event) {
  nlohmann::ordered_json line;
  const auto add = [&](const char* key, std::string_view text) {
    if (!text.empty()) line[key] = printable(text, kMaxTextBytes);
  };
  add("time", time_text());
  add("event", event.event);
  if (event.who.role != Role::kNobody) add("role", to_text(event.who.role));
  add("name", event.who.name);
  add("serial", event.who.serial);
  add("address", event.who.address);
  add("scene", event.scene);
  add("reason", event.reason);
  if (event.session) {
    line["seconds"] = std::round(1000.0 * event.session->seconds) / 1000.0;
    line["frames"] = event.session->frames;
    line["bytes"] = event.session->bytes;
  }
  return line.dump() + "\n";
}

/// Makes the lines durable, and also the name of a new file in its folder.
Status sync(const std::vector<std::shared_ptr<const UniqueFd>>& files, const std::filesystem::path& path) {
  const auto failure = [&] { return Error::from_errno(fmt::format("keeping the audit log '{}'", path.string())); };
  for (const auto& file : files) {
    if (::fdatasync(file->get()) != 0 && errno != EINVAL) return failure();  // EINVAL: the file is not on a disk.
  }
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  const UniqueFd opened(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!opened.is_open() || (::fsync(opened.get()) != 0 && errno != EINVAL)) return failure();
  return Done{};
}

}  // namespace

Result<std::unique_ptr<AuditLog>> AuditLog::open(std::filesystem::path path, std::uint64_t max_bytes) {
  std::unique_ptr<AuditLog> log(new AuditLog(std::move(path), max_bytes));
  const std::lock_guard lock(log->mutex_);
  TRY(log->open_file());
  return log;
}

AuditLog::AuditLog(std::filesystem::path path, std::uint64_t max_bytes)
    : path_(std::move(path)), max_bytes_(max_bytes), thread_([this] { run(); }) {}

AuditLog::~AuditLog() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

Status AuditLog::open_file() {
  file_.reset();
  UniqueFd file(::open(path_.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0640));
  if (!file.is_open()) return Error::from_errno(fmt::format("opening the audit log '{}'", path_.string()));
  file_ = std::make_shared<const UniqueFd>(std::move(file));
  return Done{};
}

bool AuditLog::was_moved() const {
  struct ::stat named {};
  struct ::stat open {};
  return ::stat(path_.c_str(), &named) != 0 || ::fstat(file_->get(), &open) != 0 || named.st_ino != open.st_ino ||
         named.st_dev != open.st_dev;
}

Status AuditLog::make_room(std::uint64_t bytes) {
  struct ::stat now {};
  if (::fstat(file_->get(), &now) != 0 || !S_ISREG(now.st_mode)) return Done{};
  const auto size = static_cast<std::uint64_t>(now.st_size);
  if (size == 0 || size + bytes <= max_bytes_) return Done{};
  if (::rename(path_.c_str(), (path_.string() + ".1").c_str()) != 0) {
    return Error::from_errno(fmt::format("moving the full audit log '{}' away", path_.string()));
  }
  return open_file();
}

Status AuditLog::append(const std::string& line) {
  struct ::stat before {};
  const bool is_known = ::fstat(file_->get(), &before) == 0;
  const ssize_t written = ::write(file_->get(), line.data(), line.size());
  if (written == static_cast<ssize_t>(line.size())) return Done{};
  Error failure = written < 0 ? Error::from_errno(fmt::format("writing the audit log '{}'", path_.string()))
                              : Error(ErrorCode::kSystem, fmt::format("the disk of '{}' is full", path_.string()));
  if (written > 0 && is_known && ::ftruncate(file_->get(), before.st_size) != 0) {
    failure = Error::from_errno(fmt::format("removing half a line from the audit log '{}'", path_.string()));
  }
  return failure;
}

Status AuditLog::write(const AuditEvent& event) {
  const std::string line = line_of(event);
  const std::lock_guard lock(mutex_);
  if (file_ == nullptr || was_moved()) {
    TRY(open_file());
  }
  const Status has_room = make_room(line.size());
  if (file_ == nullptr) return has_room;
  TRY(append(line));
  if (unsynced_.empty() || unsynced_.back() != file_) unsynced_.push_back(file_);
  changed_.notify_all();
  TRY(has_room);
  return std::exchange(synced_, Done{});
}

bool AuditLog::wait_for_disk(Duration limit) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, limit, [this] { return unsynced_.empty() && !is_syncing_; });
}

void AuditLog::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return stopping_ || !unsynced_.empty(); });
    if (unsynced_.empty()) return;
    const std::vector<File> files = std::exchange(unsynced_, {});
    is_syncing_ = true;
    lock.unlock();
    const Status synced = sync(files, path_);
    lock.lock();
    is_syncing_ = false;
    if (!synced) synced_ = synced;
    changed_.notify_all();
    changed_.wait_for(lock, kSyncEvery, [this] { return stopping_; });
  }
}

}  // namespace cyclorama::trust
