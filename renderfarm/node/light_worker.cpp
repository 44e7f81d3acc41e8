// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/light_worker.h"

#include <algorithm>
#include <utility>

namespace cyclorama::node {
namespace {

/// Interval at which a computation is checked.
constexpr Duration kPeriod = std::chrono::milliseconds(100);
/// Completed share below which the remaining time is not estimated.
constexpr double kMinShare = 0.02;

}  // namespace

LightWorker::LightWorker(LightStarter starter, LightFiles files, Calls calls, const Clock& clock)
    : starter_(std::move(starter)), files_(std::move(files)), calls_(std::move(calls)), clock_(clock) {}

void LightWorker::want(const std::string& path, const std::string& name) {
  if (!starter_) return;
  {
    const std::lock_guard lock(mutex_);
    if (std::ranges::find(waiting_, path, &Wanted::path) != waiting_.end()) return;
    waiting_.push_back({path, name});
  }
  changed_.notify_all();
}

void LightWorker::give_way() {
  const std::lock_guard lock(mutex_);
  block_at_ = clock_.now();
  if (current_ == nullptr || paused_) return;
  current_->pause();
  paused_ = true;
}

void LightWorker::report(wire::NodeStatus* status) const {
  const std::lock_guard lock(mutex_);
  for (std::size_t i = 0; i < waiting_.size(); ++i) {
    wire::LightProgress& progress = *status->add_light();
    progress.set_scene(waiting_[i].name);
    if (i > 0 || current_ == nullptr) continue;
    progress.set_done_share(done_share_);
    if (done_share_ >= kMinShare) progress.set_seconds_left(worked_seconds_ * (1.0 - done_share_) / done_share_);
  }
}

void LightWorker::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
}

bool LightWorker::wait() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return stopping_ || !waiting_.empty(); });
  if (!stopping_) changed_.wait_for(lock, kPeriod, [this] { return stopping_; });
  if (stopping_) current_ = nullptr;
  return !stopping_;
}

bool LightWorker::is_quiet() const { return block_at_ == TimePoint::min() || clock_.now() - block_at_ >= kQuiet; }

bool LightWorker::work() {
  const bool has_blocks = calls_.has_blocks();
  std::shared_ptr<LightComputation> current;
  Wanted wanted;
  bool may_begin = false;
  {
    const std::lock_guard lock(mutex_);
    if (waiting_.empty()) return false;
    wanted = waiting_.front();
    if (has_blocks) block_at_ = clock_.now();
    current = current_;
    may_begin = is_quiet();
    const TimePoint now = clock_.now();
    if (current != nullptr && !paused_) worked_seconds_ += to_seconds(now - looked_at_);
    looked_at_ = now;
    if (current != nullptr && paused_ && may_begin) {
      current->resume();
      paused_ = false;
    }
  }
  if (!calls_.is_wanted(wanted.path)) {
    const std::lock_guard lock(mutex_);
    current_ = nullptr;
    waiting_.pop_front();
    return true;
  }
  if (current == nullptr) {
    if (may_begin) begin(wanted);
    return true;
  }
  const double done_share = current->done_share();
  const std::optional<Status> result = current->result();
  {
    const std::lock_guard lock(mutex_);
    done_share_ = done_share;
    if (!result) return true;
    current_ = nullptr;
    waiting_.pop_front();
  }
  calls_.finished(wanted.path, file_, *result);
  return true;
}

void LightWorker::begin(const Wanted& wanted) {
  Status fine = Done{};
  std::shared_ptr<LightComputation> started;
  if (auto file = files_.prepare(wanted.path)) {
    file_ = *std::move(file);
    LightFiles::remove_left_over(file_);
    if (auto computation = starter_(wanted.path, file_)) {
      started = *std::move(computation);
    } else {
      fine = computation.error();
    }
  } else {
    fine = file.error();
  }
  {
    const std::lock_guard lock(mutex_);
    current_ = started;
    paused_ = false;
    done_share_ = 0.0;
    worked_seconds_ = 0.0;
    if (started != nullptr && !is_quiet()) {  // A block has arrived meanwhile.
      started->pause();
      paused_ = true;
    }
    if (!fine) waiting_.pop_front();
  }
  if (!fine) calls_.finished(wanted.path, {}, fine);
}

}  // namespace cyclorama::node
