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

/// At most two frames are in flight: one is rendered while the other crosses the network. A view that shows something
/// new is requested once there is room. At rest, nothing is requested from a farm that refines, since every view would
/// restart the refinement; any other farm gets one view a second, which keeps the picture fresh for displays that join.
/// Pure; thread-bound.
class ViewPacer {
 public:
  static constexpr Duration kAtRest = std::chrono::seconds(1);

  explicit ViewPacer(bool farm_refines) : farm_refines_(farm_refines) {}

  /// Returns true when `view`, regardless of its number, should be requested now.
  [[nodiscard]] bool wants(const wire::View& view, TimePoint now) const;
  /// Records that `view` was requested; its number must exceed all earlier ones.
  void asked(const wire::View& view, TimePoint now);
  /// Records that the farm began this frame. Returns how many requested views it has skipped.
  std::size_t began(std::uint64_t number);
  /// Records that the farm ended this frame, complete or not.
  void ended(std::uint64_t number);
  /// Requests the current picture once more, also at rest, for a display that joined or a farm that came back.
  void request_again() { newest_.reset(); }
  /// Records that the farm is away. FarmClient repeats the newest request when it is back.
  void lost();

  [[nodiscard]] std::size_t in_flight() const { return frames_.in_flight(); }
  [[nodiscard]] std::optional<TimePoint> asked_at() const { return asked_at_; }

 private:
  const bool farm_refines_;
  FrameWindow<std::monostate> frames_;  ///< Numbers alone: FarmClient keeps the views.
  std::optional<wire::View> newest_;
  std::optional<TimePoint> asked_at_;
};

}  // namespace cyclorama::tour
