// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <mutex>
#include <utility>
#include <vector>

#include "common/base/clock.h"

namespace cyclorama::camera {

/// Completed requests of the driver's thread, oldest first, until the camera's thread takes all of them. Holds at most
/// as many as were queued to the driver. Thread-safe.
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
  /// Called when the device is gone: wakes all present and future waiters.
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
  /// Returns all completed requests as soon as there is one; empty at the deadline or after end().
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
