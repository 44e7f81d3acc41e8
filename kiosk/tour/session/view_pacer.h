// SPDX-License-Identifier: Apache-2.0
/// Decides when the next picture is requested from the farm.
#pragma once

#include <cstdint>
#include <optional>
#include <variant>

#include "common/base/clock.h"
#include "common/base/frame_window.h"
#include "common/wire/view.pb.h"

namespace cyclorama::tour {

/// A view is requested when its frame can be shown:
///
/// 1. At most two frames are in flight: one is rendered while the other crosses the network.
/// 2. Views are at least one interval apart. The interval is the displays' refresh period, and longer while newer
/// frames
///    replace frames at the displays before those were seen: of two frames that end within one refresh, only one is
///    shown. The interval follows a staircase: it grows by kSlower for each frame that was not shown and shrinks by
///    kFaster for each frame that was, so that it settles where one frame in a hundred is not shown.
///    (Kaernbach, "Simple adaptive testing with the weighted up-down method", Perception & Psychophysics 49(3), 1991.)
/// 3. At rest, nothing is requested from a farm that refines, since every view would restart the refinement; any other
///    farm gets one view a second, which keeps the picture fresh for displays that join.
///
/// Pure; thread-bound.
class ViewPacer {
 public:
  static constexpr Duration kAtRest = std::chrono::seconds(1);
  /// Upper bound of the interval: beyond it, some wasted frames are better than fewer than two frames a second.
  static constexpr Duration kMaxInterval = std::chrono::milliseconds(500);
  static constexpr double kSlower = 0.04;
  static constexpr double kFaster = kSlower / 99.0;

  explicit ViewPacer(bool farm_refines) : farm_refines_(farm_refines) {}

  /// Sets the displays' refresh period; zero: none, so only the farm limits the rate. A different period restarts the
  /// search for the interval.
  void set_refresh_period(Duration period);
  /// Returns true when a view that shows something new may be requested now.
  [[nodiscard]] bool is_due(TimePoint now) const;
  /// Returns the time at which the interval after the last request ends; nothing before the first request, or while too
  /// many frames are in flight.
  [[nodiscard]] std::optional<TimePoint> due_at() const;
  /// Returns true when `view`, regardless of its number, should be requested now.
  [[nodiscard]] bool wants(const wire::View& view, TimePoint now) const;
  /// Records that `view` was requested; its number must exceed all earlier ones.
  void asked(const wire::View& view, TimePoint now);
  /// Records that the farm began this frame. Returns how many requested views it has skipped.
  std::size_t began(std::uint64_t number);
  /// Records that the farm ended this frame, complete or not.
  void ended(std::uint64_t number);
  /// Record that a complete frame was shown, or that it reached the displays but was not shown. `next_after` is the
  /// time from its request to the next one; that time was too short, so the interval becomes longer.
  void shown();
  void not_shown(Duration next_after);
  /// Requests the current picture once more, also at rest, for a display that joined or a farm that came back.
  void request_again() { newest_.reset(); }
  /// Records that the farm is away. FarmClient repeats the newest request when it is back.
  void lost();

  [[nodiscard]] std::size_t in_flight() const { return frames_.in_flight(); }
  [[nodiscard]] std::optional<TimePoint> asked_at() const { return asked_at_; }
  /// Minimum time between two views.
  [[nodiscard]] Duration interval() const;

 private:
  const bool farm_refines_;
  FrameWindow<std::monostate> frames_;  ///< Numbers of the frames; FarmClient keeps their views.
  std::optional<wire::View> newest_;
  std::optional<TimePoint> asked_at_;
  Duration period_ = Duration::zero();
  double periods_ = kFirstPeriods;  ///< Interval in refresh periods.
  double slower_ = kFirstSlower;

  /// Farms and displays vary a little; without this margin, the first seconds would lose frames.
  static constexpr double kFirstPeriods = 1.1;
  /// The first steps are larger, so that the interval is found within a few frames, and shrink to kSlower. A step
  /// towards a time that proved too short is at most kMaxStep.
  static constexpr double kFirstSlower = 0.2;
  static constexpr double kMaxStep = 0.5;
  static constexpr double kSettling = 0.8;
};

}  // namespace cyclorama::tour
