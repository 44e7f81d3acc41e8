// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>

namespace cyclorama::display {

/// One slot between threads, without a lock: a new value replaces the one that is there, which put() returns. It serves
/// the present thread, which must never wait. Thread-safe.
template <typename T>
class AtomicSlot {
 public:
  AtomicSlot() = default;
  AtomicSlot(const AtomicSlot&) = delete;
  AtomicSlot& operator=(const AtomicSlot&) = delete;
  ~AtomicSlot() { delete value_.load(); }

  /// Returns the value that nobody took, or null.
  std::unique_ptr<T> put(std::unique_ptr<T> value) {
    return std::unique_ptr<T>(value_.exchange(value.release(), std::memory_order_acq_rel));
  }
  /// Null when the slot is empty.
  std::unique_ptr<T> take() { return std::unique_ptr<T>(value_.exchange(nullptr, std::memory_order_acq_rel)); }
  [[nodiscard]] bool is_empty() const { return value_.load(std::memory_order_acquire) == nullptr; }

 private:
  std::atomic<T*> value_{nullptr};
};

}  // namespace cyclorama::display
