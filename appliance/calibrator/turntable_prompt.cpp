// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibrator/turntable_prompt.h"

#include <algorithm>
#include <utility>

namespace cyclorama::calibrator {
namespace {
constexpr auto kLook = std::chrono::milliseconds(200);
}

void TurntablePrompt::set_listener(Listener listener) {
  const std::lock_guard lock(mutex_);
  listener_ = std::move(listener);
}

bool TurntablePrompt::answer(const std::string& text) {
  const std::lock_guard lock(mutex_);
  if (!is_open_) return false;
  is_open_ = false;
  answer_ = text;
  changed_.notify_all();
  return true;
}

Result<std::string> TurntablePrompt::ask(const std::string& question, std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  const Listener listener = listener_;
  if (!listener) return Error(ErrorCode::kUnavailable, "nobody is there to turn the turntable");
  is_open_ = true;
  answer_.reset();
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  bool is_wanted = true;
  while (!answer_ && is_wanted && std::chrono::steady_clock::now() < deadline) {
    lock.unlock();  // The listener writes to a network and may block.
    is_wanted = listener(question);
    lock.lock();
    changed_.wait_until(lock, std::min(std::chrono::steady_clock::now() + kLook, deadline),
                        [this] { return answer_.has_value(); });
  }
  is_open_ = false;
  const std::optional<std::string> answered = std::exchange(answer_, std::nullopt);
  lock.unlock();
  if (answered && listener("")) return *answered;
  if (!is_wanted || answered) return Error(ErrorCode::kUnavailable, "cancelled");
  return Error(ErrorCode::kTimedOut, "nobody turned the turntable; calibrate again, and answer the questions");
}

}  // namespace cyclorama::calibrator
