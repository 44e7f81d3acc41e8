// SPDX-License-Identifier: Apache-2.0
/// When the farm is asked for the next picture.
#pragma once

#include <cstdint>
#include <optional>
#include <set>

#include "common/base/clock.h"
#include "common/wire/view.pb.h"

namespace cyclorama {

/// At most two frames are in flight: one is rendered while the other crosses the network. As soon as there is room, a
/// view that shows something new is asked for. At rest, a farm that refines is left alone, for every view would make it
/// begin anew; of any other, one view a second keeps the picture fresh for displays that join.
/// Pure; thread-bound.
class ViewPacer {
 public:
  static constexpr std::size_t kFramesInFlight = 2;
  static constexpr Duration kAtRest = std::chrono::seconds(1);

  explicit ViewPacer(bool farm_refines) : farm_refines_(farm_refines) {}

  /// Whether `view`, whose number does not matter, is worth asking for now.
  [[nodiscard]] bool wants(const wire::View& view, TimePoint now) const;
  /// `view` was asked for; its number is larger than all before.
  void asked(const wire::View& view, TimePoint now);
  /// The farm began this frame. Returns how many asked views it has passed over.
  std::size_t began(std::uint64_t number);
  /// The farm ended this frame, complete or not.
  void ended(std::uint64_t number);
  /// Somebody has not seen the picture that is there, a display that joined or a farm that came back: it is asked for
  /// once more, at rest, too.
  void ask_again() { newest_.reset(); }
  /// The farm is away. It will be asked for the newest again when it is back (FarmClient's doing).
  void lost();

  [[nodiscard]] std::size_t in_flight() const { return in_flight_.size(); }
  [[nodiscard]] std::optional<TimePoint> asked_at() const { return asked_at_; }

 private:
  const bool farm_refines_;
  std::set<std::uint64_t> in_flight_;
  std::optional<wire::View> newest_;
  std::optional<TimePoint> asked_at_;
};

}  // namespace cyclorama
