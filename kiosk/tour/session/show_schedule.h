// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>

#include "common/base/clock.h"
#include "common/wire/museum.pb.h"

namespace cyclorama {

/// The largest of the last minute's values. It follows a larger one at once, and lets go of it a minute later: were it
/// a shorter time, every hiccup would be met again by surprise. Thread-bound.
class LongestLately {
 public:
  explicit LongestLately(Duration at_first) : at_first_(at_first) {}
  void add(Duration value, TimePoint now);
  /// What it was given at first, until a value comes.
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

/// Says at which shared refresh (wire::ShowAt) several displays are to show a frame or a heading first: the next one
/// that the slowest of them can make, by what all of them needed in the last minute.
///
///   said ──▶ network ──▶ decode ──▶ drawn for ──▶ shared refresh
///    └──────────── frame_need_s ─────────────────────┘
///
/// 1. A display alone is told nothing: it shows everything at once.
/// 2. A display that needs more than kLongestLead is not waited for. It shows frames when it can.
/// 3. Shared refreshes come at the rate of the slowest display, so that every display has one for each.
/// 4. Frames get refreshes of their own as long as they come no faster than those.
///
/// Thread-safe.
class ShowSchedule {
 public:
  static constexpr Duration kLongestLead = std::chrono::milliseconds(250);

  void joined(std::uint64_t display, const wire::DisplayHello& hello);
  void left(std::uint64_t display);
  void measured(const wire::ClockQuestion& question, TimePoint now);

  [[nodiscard]] std::optional<wire::ShowAt> frame_at(TimePoint now);
  [[nodiscard]] std::optional<wire::ShowAt> heading_at(TimePoint now);

  /// What is added to the way of a frame, and of a heading, so that all can show it; 0 with a display alone.
  [[nodiscard]] Duration frame_lead(TimePoint now) const;
  [[nodiscard]] Duration heading_lead(TimePoint now) const;

 private:
  [[nodiscard]] bool is_shared() const { return rates_hz_.size() > 1; }
  [[nodiscard]] std::int64_t first_refresh(TimePoint now, Duration lead) const;
  [[nodiscard]] wire::ShowAt show_at(std::int64_t refresh, TimePoint now) const;
  void choose_period();

  mutable std::mutex mutex_;  ///< Guards the following.
  std::map<std::uint64_t, double> rates_hz_;
  Duration period_{std::chrono::nanoseconds(16'666'667)};
  LongestLately frame_need_{std::chrono::milliseconds(80)};
  LongestLately heading_need_{std::chrono::milliseconds(40)};
  std::int64_t last_frame_ = 0;
  std::int64_t last_heading_ = 0;
};

}  // namespace cyclorama
