// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <type_traits>

namespace cyclorama::display {

/// Passes the newest of many small values from one thread to another, without a lock or allocation: a new value
/// replaces one that was not taken. Neither side ever waits. There are three slots: one is written, one is read, and
/// one holds the newest complete value.
template <typename T>
class NewestValue {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  /// Called by the only producer (or several, one at a time).
  void put(const T& value) {
    slots_[written_] = value;
    written_ = between_.exchange(written_ | kIsNew, std::memory_order_acq_rel) & kSlot;
  }
  /// Called by the only consumer. Returns false and leaves `*ret_value` alone if there is nothing new.
  bool take(T* ret_value) {
    if ((between_.load(std::memory_order_relaxed) & kIsNew) == 0) return false;
    read_ = between_.exchange(read_, std::memory_order_acq_rel) & kSlot;
    *ret_value = slots_[read_];
    return true;
  }

 private:
  static constexpr unsigned kSlot = 3;
  static constexpr unsigned kIsNew = 4;
  std::array<T, 3> slots_{};
  unsigned written_ = 0;
  std::atomic<unsigned> between_{1};
  unsigned read_ = 2;
};

}  // namespace cyclorama::display
