// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <deque>
#include <mutex>
#include <utility>

#include "common/base/clock.h"

namespace cyclorama::coordinator {

/// A queue with many posting threads and one consuming loop. The queue itself is unbounded, but each stream has at most
/// one message and one finished write in it. Thread-safe.
template <typename Event>
class EventQueue {
 public:
  /// Queues an event. After close(), drops it and returns false.
  bool post(Event event) {
    {
      const std::lock_guard lock(mutex_);
      if (closed_) return false;
      events_.push_back(std::move(event));
    }
    posted_.notify_one();
    return true;
  }
  /// Returns all queued events; if there are none, waits for one until `deadline` or close().
  std::deque<Event> take_all(TimePoint deadline) {
    std::unique_lock lock(mutex_);
    posted_.wait_until(lock, deadline, [this] { return closed_ || !events_.empty(); });
    return std::exchange(events_, {});
  }
  void close() {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    posted_.notify_all();
  }
  [[nodiscard]] bool is_closed() const {
    const std::lock_guard lock(mutex_);
    return closed_;
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable posted_;
  std::deque<Event> events_;
  bool closed_ = false;
};

}  // namespace cyclorama::coordinator
