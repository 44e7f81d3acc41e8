// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "common/base/clock.h"
#include "drivers/output/drm/card.h"

namespace cyclorama::output {

/// When all CRTCs of one commit had their new picture.
struct Flipped {
  TimePoint at{};          ///< Of the last of them.
  bool has_vblank = true;  ///< False: the card has no raster, so that its flips happen at once (virtual ones).
};

/// Waits for a card's page-flip events. One commit at a time is waited for; events of an earlier one that was given up
/// are told from it by their cookie. Its address is in the kernel's hands: not movable. Borrows the clock.
/// Thread-bound.
class FlipWaiter {
 public:
  explicit FlipWaiter(const Clock& clock) : clock_(clock) {}
  FlipWaiter(const FlipWaiter&) = delete;
  FlipWaiter& operator=(const FlipWaiter&) = delete;

  /// The cookie for a commit that touches so many CRTCs.
  [[nodiscard]] void* expect(std::size_t crtcs);
  /// The commit failed: no event will come.
  void cancel();
  [[nodiscard]] bool is_waiting() const { return current_ != nullptr; }
  /// Blocks until every event has come. kTimedOut  not within `timeout`: the commit is given up.   Others as errno
  /// says. Precondition: is_waiting().
  Result<Flipped> wait(const Card& card, std::chrono::milliseconds timeout);
  /// When a CRTC of the commit that was waited for last had its new picture; nothing if it was not part of it.
  [[nodiscard]] std::optional<TimePoint> flipped_at(std::uint32_t crtc_id) const;

 private:
  struct CrtcFlip {
    std::uint32_t id = 0;
    TimePoint at{};
  };
  struct Commit {
    FlipWaiter* waiter = nullptr;
    std::size_t missing = 0;
    Flipped flipped;
    std::array<CrtcFlip, 32> crtcs{};  // As many as a card can have.
    std::size_t crtc_count = 0;
  };
  static void on_flip(int fd, unsigned sequence, unsigned seconds, unsigned microseconds, unsigned crtc_id,
                      void* cookie);

  const Clock& clock_;
  const Card* card_ = nullptr;  // During wait().
  // Enough that events of one that was given up have come, or never will, before its place is used again.
  std::array<Commit, 16> commits_{};
  std::size_t next_ = 0;
  Commit* current_ = nullptr;
  const Commit* done_ = nullptr;  // The last that was waited for, if it succeeded.
};

}  // namespace cyclorama::output
