// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <future>
#include <memory>
#include <thread>

#include "appliance/display/atomic_slot.h"
#include "appliance/display/output_supervisor.h"
#include "common/base/unique_fd.h"

namespace cyclorama::display {

/// The thread that owns GL and shows pictures, even after the output was lost and reopened. Thread-bound to the thread
/// that starts it.
class PresentThread {
 public:
  /// Opens the output, without drawing yet. Blocks until the output is open, and meanwhile calls `on_step`, which may
  /// be null, about once for each second in which there was progress (PresentMailbox::stepped_at). Borrows the mailbox
  /// and the clock. Errors: those of OutputSupervisor::open().
  static Result<std::unique_ptr<PresentThread>> start(PresentPlan plan, PresentMailbox* mailbox, const Clock* clock,
                                                      const std::function<void()>& on_step = nullptr);
  /// Ends the thread after the present refresh.
  ~PresentThread() = default;

  /// Returns the output's state; null if it has not changed since the last call. The first state is ready after
  /// start().
  [[nodiscard]] std::unique_ptr<OutputState> take_state() { return state_.take(); }
  /// Maximum side of a picture on the graphics card. Thread-safe.
  [[nodiscard]] int max_side_px() const { return max_side_px_; }
  /// False if the driver hangs: a step has lasted longer than 20 s and longer than four times the longest completed
  /// step.
  [[nodiscard]] bool is_alive() const;
  /// File descriptor for poll(): readable after every refresh in the mailbox, and occasionally without one. drain()
  /// resets it.
  [[nodiscard]] int event_fd() const { return event_fd_.get(); }
  void drain() const;

 private:
  PresentThread(const PresentMailbox* mailbox, const Clock* clock) : mailbox_(*mailbox), clock_(*clock) {}
  void run(PresentPlan plan, PresentMailbox* mailbox, const std::stop_token& stop);
  void tell(const OutputState& state);

  const PresentMailbox& mailbox_;
  const Clock& clock_;
  UniqueFd event_fd_;
  AtomicSlot<OutputState> state_;
  std::atomic<int> max_side_px_{0};
  std::promise<Status> started_;  // Set once the members above are set.
  std::jthread thread_;           // Last member, so that the thread ends before what it uses.
};

}  // namespace cyclorama::display
