// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace cyclorama::display {

/// A bounded, lock-free queue from one producer thread to one consumer thread; it allocates nothing. When it is full, a
/// pushed event is dropped and counted: the present thread never waits for a consumer.
template <typename T, std::size_t Capacity>
class EventRing {
 public:
  /// Called by the only producer.
  void push(const T& event) {
    const std::size_t at = written_.load(std::memory_order_relaxed);
    if (at - read_.load(std::memory_order_acquire) == Capacity) {
      lost_.fetch_add(1, std::memory_order_relaxed);
      return;
    }
    events_[at % Capacity] = event;
    written_.store(at + 1, std::memory_order_release);
  }
  /// Called by the only consumer.
  std::optional<T> pop() {
    const std::size_t at = read_.load(std::memory_order_relaxed);
    if (at == written_.load(std::memory_order_acquire)) return std::nullopt;
    T event = events_[at % Capacity];
    read_.store(at + 1, std::memory_order_release);
    return event;
  }
  [[nodiscard]] std::uint64_t lost() const { return lost_.load(std::memory_order_relaxed); }

 private:
  std::array<T, Capacity> events_{};
  std::atomic<std::size_t> written_{0};
  std::atomic<std::size_t> read_{0};
  std::atomic<std::uint64_t> lost_{0};
};

}  // namespace cyclorama::display
