// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>

#include "common/base/clock.h"
#include "common/wire/museum.pb.h"

namespace cyclorama::tour {

/// Maximum of the values of the last minute. A larger value counts at once and is dropped after a minute; with a
/// shorter window, delays that recur every few seconds would be missed again and again. Thread-bound.
class RecentMaximum {
 public:
  explicit RecentMaximum(Duration at_first) : at_first_(at_first) {}
  void add(Duration value, TimePoint now);
  /// Returns the maximum; the initial value until a value is added.
  [[nodiscard]] Duration at(TimePoint now) const;

 private:
  struct Second {
    std::int64_t number = -1;
    Duration longest{};
  };
  static constexpr std::int64_t kSeconds = 60;
  Duration at_first_;
  std::array<Second, kSeconds> seconds_{};
};

/// Returns the time between two refreshes of a display; a millisecond if the display states an impossible rate.
[[nodiscard]] Duration refresh_period_of(const wire::DisplayHello& hello);

/// Chooses the synchronised refresh (wire::ShowAt) at which several displays first show a frame or a heading: the next
/// one that the slowest of them can make, judged by the time that each display needed in the last minute.
///
///   sent ──▶ network ──▶ decode ──▶ drawn for ──▶ synchronised refresh
///    └──────────── frame_need_s ─────────────────────┘
///
/// 1. A single display gets no schedule: it shows everything at once.
/// 2. A display that needs more than kMaxLead is not waited for. It shows frames when it can.
/// 3. Synchronised refreshes come at the rate of the slowest display, so that every display has a refresh for each of
/// them.
/// 4. Each frame has a refresh of its own as long as frames come no faster than refreshes.
///
/// Thread-safe.
class ShowSchedule {
 public:
  static constexpr Duration kMaxLead = std::chrono::milliseconds(250);

  void joined(std::uint64_t display, const wire::DisplayHello& hello);
  void left(std::uint64_t display);
  void measured(const wire::ClockRequest& question, TimePoint now);

  [[nodiscard]] std::optional<wire::ShowAt> frame_at(TimePoint now);
  [[nodiscard]] std::optional<wire::ShowAt> heading_at(TimePoint now);

  /// Return the delay that is added to a frame or heading so that all displays can show it; 0 with a single display.
  [[nodiscard]] Duration frame_lead(TimePoint now) const;
  [[nodiscard]] Duration heading_lead(TimePoint now) const;

 private:
  [[nodiscard]] bool is_shared() const { return periods_.size() > 1; }
  [[nodiscard]] std::int64_t first_refresh(TimePoint now, Duration lead) const;
  [[nodiscard]] wire::ShowAt show_at(std::int64_t refresh, TimePoint now) const;
  void choose_period();

  mutable std::mutex mutex_;  ///< Guards the following.
  std::map<std::uint64_t, Duration> periods_;
  Duration period_{std::chrono::nanoseconds(16'666'667)};
  RecentMaximum frame_need_{std::chrono::milliseconds(80)};
  RecentMaximum heading_need_{std::chrono::milliseconds(40)};
  std::int64_t last_frame_ = 0;
  std::int64_t last_heading_ = 0;
};

}  // namespace cyclorama::tour
