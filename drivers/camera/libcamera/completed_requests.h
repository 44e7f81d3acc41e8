// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <mutex>
#include <utility>
#include <vector>

#include "common/base/clock.h"

namespace cyclorama::camera {

/// What a driver's thread has finished, oldest first, until the camera's thread takes all of it. At most as many as the
/// driver was given. Thread-safe.
template <typename Request>
class CompletedRequests {
 public:
  void put(Request* request) {
    {
      const std::lock_guard lock(mutex_);
      completed_.push_back(request);
    }
    changed_.notify_one();
  }
  /// The device is gone: wakes who waits, now and later.
  void end() {
    {
      const std::lock_guard lock(mutex_);
      ended_ = true;
    }
    changed_.notify_all();
  }
  [[nodiscard]] bool has_ended() const {
    const std::lock_guard lock(mutex_);
    return ended_;
  }
  /// All of them, as soon as there is one; none at the deadline, or at the end.
  [[nodiscard]] std::vector<Request*> take_before(TimePoint deadline) {
    std::unique_lock lock(mutex_);
    changed_.wait_until(lock, deadline, [this] { return ended_ || !completed_.empty(); });
    return std::exchange(completed_, {});
  }
  void clear() {
    const std::lock_guard lock(mutex_);
    completed_.clear();
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Request*> completed_;
  bool ended_ = false;
};

}  // namespace cyclorama::camera
