// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <future>
#include <memory>
#include <thread>

#include "appliance/display/atomic_slot.h"
#include "appliance/display/output_keeper.h"
#include "common/base/unique_fd.h"

namespace cyclorama {

/// The thread that owns GL and shows, whatever happens to the output. Thread-bound to whoever starts it.
class PresentThread {
 public:
  /// Opens the output and draws nothing yet. Borrows the mailbox and the clock.
  /// Errors of OutputKeeper::open(); kTimedOut when the driver takes longer than 270 s.
  static Result<std::unique_ptr<PresentThread>> start(PresentPlan plan, PresentMailbox* mailbox, const Clock* clock);
  /// Ends with the refresh that it is in.
  ~PresentThread() = default;

  /// How the output fares; null when nothing has changed since the last time. The first comes with start().
  [[nodiscard]] std::unique_ptr<OutputState> take_state() { return state_.take(); }
  /// The largest side of a picture that the graphics card takes. Thread-safe.
  [[nodiscard]] int largest_side_px() const { return largest_side_px_; }
  /// False when a refresh lasts longer than 2 s, or an attempt to open a lost output longer than 20 s: the driver
  /// hangs.
  [[nodiscard]] bool is_alive() const;
  /// Readable whenever a refresh was told to the mailbox, and now and then; for poll(). Reset it with drain().
  [[nodiscard]] int event_fd() const { return event_fd_.get(); }
  void drain() const;

 private:
  explicit PresentThread(const Clock* clock) : clock_(*clock) {}
  void run(PresentPlan plan, PresentMailbox* mailbox, const std::stop_token& stop);
  void tell(const OutputState& state);

  const Clock& clock_;
  UniqueFd event_fd_;
  AtomicSlot<OutputState> state_;
  std::atomic<int> largest_side_px_{0};
  std::atomic<bool> is_lost_{false};
  std::atomic<TimePoint> turn_began_at_{};
  std::promise<Status> started_;  // Set when the members above are.
  std::jthread thread_;           // Last: it ends before what it uses.
};

}  // namespace cyclorama
