// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>

namespace cyclorama::display {

/// A lock-free slot that passes one value between threads: a new value replaces the former one, which put() returns. It
/// serves the present thread, which must never wait. Thread-safe.
template <typename T>
class AtomicSlot {
 public:
  AtomicSlot() = default;
  AtomicSlot(const AtomicSlot&) = delete;
  AtomicSlot& operator=(const AtomicSlot&) = delete;
  ~AtomicSlot() { delete value_.load(); }

  /// Stores `value`. Returns the former value if nobody took it, else null.
  std::unique_ptr<T> put(std::unique_ptr<T> value) {
    return std::unique_ptr<T>(value_.exchange(value.release(), std::memory_order_acq_rel));
  }
  /// Returns null if the slot is empty.
  std::unique_ptr<T> take() { return std::unique_ptr<T>(value_.exchange(nullptr, std::memory_order_acq_rel)); }
  [[nodiscard]] bool is_empty() const { return value_.load(std::memory_order_acquire) == nullptr; }

 private:
  std::atomic<T*> value_{nullptr};
};

}  // namespace cyclorama::display
