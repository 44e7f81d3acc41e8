// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "common/base/clock.h"
#include "drivers/output/drm/card.h"

namespace cyclorama::output {

/// Completion of a commit: all of its CRTCs show their new picture.
struct Flipped {
  TimePoint at{};          ///< Flip time of the last CRTC.
  bool has_vblank = true;  ///< False if the card has no vertical blank, so that flips happen at once (virtual cards).
};

/// Waits for a card's page-flip events, for one commit at a time; the cookie distinguishes events of an earlier commit
/// that timed out. Cookies point into the waiter, so it is not movable. Borrows the clock. Thread-bound.
class FlipWaiter {
 public:
  explicit FlipWaiter(const Clock& clock) : clock_(clock) {}
  FlipWaiter(const FlipWaiter&) = delete;
  FlipWaiter& operator=(const FlipWaiter&) = delete;

  /// Returns the cookie for a commit that touches this number of CRTCs.
  [[nodiscard]] void* expect(std::size_t crtcs);
  /// Call this after a failed commit, for which no event will come.
  void cancel();
  [[nodiscard]] bool is_waiting() const { return current_ != nullptr; }
  /// Blocks until every event has come. Precondition: is_waiting(). Errors: kTimedOut if they do not come within
  /// `timeout` (the commit is abandoned); others from errno.
  Result<Flipped> wait(const Card& card, std::chrono::milliseconds timeout);
  /// Returns the time at which a CRTC got its new picture in the last awaited commit; nothing if it was not part of
  /// that commit.
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
    std::array<CrtcFlip, 32> crtcs{};  // Maximum number of CRTCs of a card.
    std::size_t crtc_count = 0;
  };
  static void on_flip(int fd, unsigned sequence, unsigned seconds, unsigned microseconds, unsigned crtc_id,
                      void* cookie);

  const Clock& clock_;
  const Card* card_ = nullptr;  // Set only during wait().
  // Large enough that all events of an abandoned commit have come, or never will, before its slot is used again.
  std::array<Commit, 16> commits_{};
  std::size_t next_ = 0;
  Commit* current_ = nullptr;
  const Commit* done_ = nullptr;  // Last awaited commit, if it succeeded.
};

}  // namespace cyclorama::output
