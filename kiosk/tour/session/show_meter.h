// SPDX-License-Identifier: Apache-2.0
/// Measures how long frames take from their request to a display's light, and how often one is shown.
#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "common/base/clock.h"
#include "common/base/percentiles.h"

namespace cyclorama::tour {

/// Medians of the last frames of each display, so that a single late frame, or a rest of the visitor, has no effect.
/// Pure: every time is passed in, on the tour's clock. Thread-bound.
///
///   asked ──────── farm ────────▶ ended ── network, decode ──▶ drawing ──────▶ presented
///    │                              │                          takes the newest   │
///    │                              │                          heading            │
///    └──────────────────────────────┼────────────── latency ──────────────────────┤
///                                   └──────── the display's own part ─────────────┘
class ShowMeter {
 public:
  /// Upper bound of a measured latency; longer ones are clamped.
  static constexpr Duration kMaxLatency = std::chrono::seconds(2);
  /// A longer gap between two frames is a rest and is not counted as an interval.
  static constexpr Duration kMaxInterval = std::chrono::seconds(1);
  /// Frames that a display must have shown before its times are used.
  static constexpr std::uint64_t kMinFrames = 3;

  void joined(std::uint64_t display, Duration refresh_period);
  void left(std::uint64_t display);

  /// Records that the view was requested; numbers increase.
  void asked(std::uint64_t number, TimePoint now);
  /// Records that the farm delivered the first complete frame of the view.
  void ended(std::uint64_t number, TimePoint now);
  /// Forgets the frames in flight, when the farm is away.
  void lost() { frames_.clear(); }
  /// Records a display's report. `drawing` is the time from the start of drawing, when the display takes the newest
  /// heading, to the light. Returns true for the first report of a requested view's frame by any display.
  bool presented(std::uint64_t display, std::uint64_t number, Duration drawing, TimePoint now);
  /// Records that a display did not show the frame. If the frame was complete and no display has shown it, returns the
  /// time from its request to the next request, an interval that was too short; zero if there was no next request.
  std::optional<Duration> not_shown(std::uint64_t display, std::uint64_t number);

  /// The slowest display's time from the request to the light; nothing before enough frames were shown.
  [[nodiscard]] std::optional<Duration> latency() const;
  /// The slowest display's time between two frames; nothing before enough frames were shown.
  [[nodiscard]] std::optional<Duration> interval() const;
  /// Returns how far ahead of the newest pose a frame that is requested now should be, so that it is correct in the
  /// middle of its time on the wall: the latency plus half an interval, less the time from a pose to the light, which
  /// is the drawing time, or `heading_lead` where displays are synchronised. Zero before enough frames were shown.
  [[nodiscard]] Duration ahead(Duration heading_lead) const;

  /// The slowest display's refresh period; zero without displays.
  [[nodiscard]] Duration refresh_period() const;
  /// True while the reports of all displays are overdue, so that another frame would only wait at the displays. A
  /// display whose report is missing for longer than kMaxInterval does not count as overdue.
  [[nodiscard]] bool are_displays_late(TimePoint now) const;

 private:
  struct Frame {
    TimePoint asked_at{};
    std::optional<TimePoint> ended_at;
    bool is_presented = false;
  };
  struct Screen {
    Duration period{};
    Percentiles latency_s{kWindow};
    Percentiles drawing_s{kWindow};
    Percentiles interval_s{kWindow};
    Percentiles own_s{kWindow};  ///< From the frame's end to the report.
    std::optional<TimePoint> presented_at;
    std::uint64_t reported = 0;  ///< Largest number that was presented or not shown.
  };
  static constexpr std::size_t kWindow = 15;
  static constexpr std::size_t kMaxFrames = 64;
  [[nodiscard]] bool is_late(const Screen& screen, TimePoint now) const;

  std::map<std::uint64_t, Frame> frames_;
  std::map<std::uint64_t, Screen> screens_;
};

}  // namespace cyclorama::tour
