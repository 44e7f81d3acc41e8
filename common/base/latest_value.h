// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>
#include <utility>

#include "common/base/clock.h"

namespace cyclorama {

/// A slot for one value between threads: a new value replaces an unread older one, so no queue forms. Thread-safe.
template <typename T>
class LatestValue {
 public:
  /// Replaces the stored value. Returns true if an unread value was dropped.
  bool put(T value) {
    std::unique_lock lock(mutex_);
    const bool dropped = value_.has_value();
    value_ = std::move(value);
    lock.unlock();
    changed_.notify_one();
    return dropped;
  }

  /// Takes the value; empty if the slot is empty. Never blocks for long.
  [[nodiscard]] std::optional<T> take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(value_, std::nullopt);
  }

  /// Waits for a value until `deadline` or close(), and takes it; empty if none came.
  [[nodiscard]] std::optional<T> take_before(TimePoint deadline) {
    std::unique_lock lock(mutex_);
    changed_.wait_until(lock, deadline, [this] { return value_.has_value() || closed_; });
    return std::exchange(value_, std::nullopt);
  }

  /// Wakes all current and future waiters. A value that is still stored can be taken.
  void close() {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    changed_.notify_all();
  }
  [[nodiscard]] bool is_closed() const {
    const std::lock_guard lock(mutex_);
    return closed_;
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<T> value_;
  bool closed_ = false;
};

}  // namespace cyclorama
