// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/session/stop_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <utility>

#include "common/base/file.h"

namespace cyclorama::tour {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kExtension = ".picture";
constexpr Duration kPoll = std::chrono::milliseconds(100);
constexpr Duration kFetchTimeout = std::chrono::minutes(30);  // For one picture at the slowest farm.
constexpr Duration kAfterFailure = std::chrono::seconds(10);
constexpr std::size_t kMaxVisitBytes = std::size_t{16} << 20;

}  // namespace

std::string StopPictures::Wanted::key() const {
  return fmt::format("{}-{:016x}", stop, checksum_of(view.SerializeAsString() + std::to_string(scene)));
}

Result<std::unique_ptr<StopPictures>> StopPictures::open(fs::path folder, std::uint64_t max_bytes,
                                                         client::FarmClientOptions farm) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return Error(ErrorCode::kSystem, fmt::format("creating '{}': {}", folder.string(), error.message()));
  return std::unique_ptr<StopPictures>(new StopPictures(std::move(folder), max_bytes, std::move(farm)));
}

StopPictures::StopPictures(fs::path folder, std::uint64_t max_bytes, client::FarmClientOptions farm)
    : folder_(std::move(folder)), max_bytes_(max_bytes), farm_(std::move(farm)) {
  list_files();
  pictures_ = std::thread([this] { run(); });
}

StopPictures::~StopPictures() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  changed_.notify_all();
  pictures_.join();
}

void StopPictures::list_files() {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder_, error)) {
    if (entry.path().extension() == kExtension) files_[entry.path().stem().string()] = entry.file_size(error);
  }
}

std::optional<KeptVisit> StopPictures::earlier_visit() const {
  const auto bytes = read_text_file(visit_file(), kMaxVisitBytes);
  if (!bytes) return std::nullopt;
  auto visit = parse_kept_visit(*bytes);
  if (!visit) return std::nullopt;  // The farm will describe the scene again.
  return *std::move(visit);
}

void StopPictures::set_wanted(const KeptVisit& visit, std::vector<Wanted> wanted) {
  {
    const std::lock_guard lock(mutex_);
    if (wanted == wanted_) return;
    wanted_ = std::move(wanted);
    too_large_.clear();
    trouble_.clear();
    std::set<std::string> keys;
    for (const Wanted& each : wanted_) keys.insert(each.key());
    std::erase_if(files_, [&](const auto& file) {
      if (keys.contains(file.first)) return false;
      std::error_code error;
      fs::remove(file_of(file.first), error);
      return true;
    });
    const Status written = write_file_atomically(visit_file(), to_bytes(visit));
    if (!written) trouble_ = written.error().message();
  }
  changed_.notify_all();
}

void StopPictures::allow(bool may_fetch) {
  {
    const std::lock_guard lock(mutex_);
    if (std::exchange(may_fetch_, may_fetch) == may_fetch) return;
  }
  changed_.notify_all();
}

bool StopPictures::is_kept(const std::string& stop) const {
  const std::lock_guard lock(mutex_);
  return std::ranges::any_of(wanted_, [&](const Wanted& w) { return w.stop == stop && files_.contains(w.key()); });
}

Result<KeptPicture> StopPictures::read(const std::string& stop) {
  std::string key;
  {
    const std::lock_guard lock(mutex_);
    const auto wanted = std::ranges::find(wanted_, stop, &Wanted::stop);
    if (wanted != wanted_.end()) key = wanted->key();
    if (!files_.contains(key)) return Error(ErrorCode::kNotFound, fmt::format("no picture of '{}' is kept", stop));
  }
  const auto bytes = read_text_file(file_of(key), kMaxKeptBytes);
  auto picture = bytes ? parse_kept_picture(*bytes) : Result<KeptPicture>(bytes.error());
  if (picture) return picture;
  const std::lock_guard lock(mutex_);
  std::error_code error;
  fs::remove(file_of(key), error);
  files_.erase(key);
  changed_.notify_all();
  return picture;
}

StopPictures::Progress StopPictures::progress() const {
  const std::lock_guard lock(mutex_);
  Progress progress;
  progress.wanted = wanted_.size();
  progress.kept = static_cast<std::size_t>(
      std::ranges::count_if(wanted_, [&](const Wanted& wanted) { return files_.contains(wanted.key()); }));
  progress.bytes = kept_bytes();
  progress.trouble = trouble_;
  if (!too_large_.empty() && trouble_.empty()) {
    progress.trouble = fmt::format("{} of {} pictures do not fit in the {} MiB of keep_mib", too_large_.size(),
                                   wanted_.size(), max_bytes_ >> 20);
  }
  return progress;
}

std::uint64_t StopPictures::kept_bytes() const {
  std::uint64_t bytes = 0;
  for (const auto& [key, size] : files_) bytes += size;
  return bytes;
}

const StopPictures::Wanted* StopPictures::missing() const {
  const auto found = std::ranges::find_if(wanted_, [&](const Wanted& wanted) {
    const std::string key = wanted.key();
    return !files_.contains(key) && !too_large_.contains(key);
  });
  return found == wanted_.end() ? nullptr : &*found;
}

void StopPictures::run() {
  std::unique_lock lock(mutex_);
  while (!is_stopping_) {
    const Wanted* const next = may_fetch_ ? missing() : nullptr;
    if (next == nullptr) {
      changed_.wait(lock);
      continue;
    }
    fetch(Wanted(*next), &lock);
    if (!trouble_.empty()) changed_.wait_for(lock, kAfterFailure, [this] { return is_stopping_; });
  }
}

void StopPictures::fetch(const Wanted& wanted, std::unique_lock<std::mutex>* lock) {
  trouble_.clear();
  lock->unlock();
  auto started = PictureFetch::start(farm_, wanted.view);
  lock->lock();
  if (!started) {
    trouble_ = started.error().message();
    return;
  }
  std::unique_ptr<PictureFetch> running = *std::move(started);
  std::optional<Result<KeptPicture>> result;
  const TimePoint end = SteadyClock().now() + kFetchTimeout;
  const auto is_wanted = [&] { return std::ranges::find(wanted_, wanted) != wanted_.end(); };
  while (!is_stopping_ && may_fetch_ && is_wanted() && !(result = running->take_result()) && SteadyClock().now() < end)
    changed_.wait_for(*lock, kPoll);
  lock->unlock();
  running.reset();
  lock->lock();
  if (!result || !is_wanted()) return;
  const Status kept = *result ? keep(wanted, **result) : Status(result->error());
  if (!kept) trouble_ = kept.error().message();
}

Status StopPictures::keep(const Wanted& wanted, const KeptPicture& picture) {
  const std::string bytes = to_bytes(picture);
  const std::string key = wanted.key();
  if (bytes.size() > kMaxKeptBytes || kept_bytes() + bytes.size() > max_bytes_) {
    too_large_.insert(key);
    return Done{};
  }
  TRY(write_file_atomically(file_of(key), bytes));
  files_[key] = bytes.size();
  return Done{};
}

}  // namespace cyclorama::tour
