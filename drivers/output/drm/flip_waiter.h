// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/base/clock.h"
#include "drivers/output/drm/card.h"

namespace cyclorama::output {

/// A CRTC shows the picture of a commit.
struct Flipped {
  TimePoint at{};
  bool has_vblank = true;  ///< False if the card has no vertical blank, so that flips happen at once (virtual cards).
};

/// Follows a card's commits, of which several may be under way on different CRTCs, by their page-flip events. The
/// cookie distinguishes events of an earlier commit that timed out. Cookies point into the waiter, so it is not
/// movable. Borrows the clock. Thread-bound.
class FlipWaiter {
 public:
  explicit FlipWaiter(const Clock& clock) : clock_(clock) {}
  FlipWaiter(const FlipWaiter&) = delete;
  FlipWaiter& operator=(const FlipWaiter&) = delete;

  /// Returns the cookie for a commit on these CRTCs, each of which sends one event by `deadline`. Precondition: no
  /// other commit is under way on them.
  [[nodiscard]] void* expect(std::span<const std::uint32_t> crtc_ids, TimePoint deadline);
  /// Call this after a failed commit, for which no event will come.
  void cancel(void* cookie);
  /// Abandons all commits.
  void cancel_all();

  [[nodiscard]] bool is_waiting_for(std::uint32_t crtc_id) const;
  [[nodiscard]] bool is_waiting() const;
  /// Returns whether a commit should have been complete by now.
  [[nodiscard]] bool is_overdue() const;
  /// Returns the earliest deadline of a commit that is under way. Precondition: is_waiting().
  [[nodiscard]] TimePoint next_deadline() const;
  /// Waits at most until `until` for events, and takes those that have come. Errors: from errno.
  Status take_events(const Card& card, TimePoint until);
  /// Returns when a CRTC completed a commit since the last clear(); nothing if it did not.
  [[nodiscard]] std::optional<Flipped> flipped(std::uint32_t crtc_id) const;
  void clear();

 private:
  struct Commit {
    FlipWaiter* waiter = nullptr;
  };
  struct CrtcState {
    std::uint32_t id = 0;
    const Commit* awaited = nullptr;
    TimePoint deadline{};
    std::optional<Flipped> flipped;
  };
  static void on_flip(int fd, unsigned sequence, unsigned seconds, unsigned microseconds, unsigned crtc_id,
                      void* cookie);
  [[nodiscard]] const CrtcState* find(std::uint32_t crtc_id) const;

  const Clock& clock_;
  const Card* card_ = nullptr;  // Set only during take_events().
  // Large enough that all events of an abandoned commit have come, or never will, before its slot is used again.
  std::array<Commit, 64> commits_{};
  std::size_t next_ = 0;
  std::vector<CrtcState> crtcs_;  // CRTCs that had a commit.
};

}  // namespace cyclorama::output
