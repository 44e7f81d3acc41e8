// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <utility>

#include "appliance/healing/estimator/light_plane.h"
#include "common/base/clock.h"

namespace cyclorama::healing {

/// Picture that a projector shows from a time on: the head's whole picture, as it left the graphics card.
struct ShownPicture {
  std::size_t projector = 0;
  TimePoint lit_at;                         ///< Presentation time plus the projector's latency.
  std::shared_ptr<const RgbImage> picture;  ///< Null while the lamp is off.
  std::uint64_t number = 0;                 ///< Increases by one with each picture of this projector, reported or not.
};

/// Time until which a projector's pictures are known.
struct ShownUntil {
  std::size_t projector = 0;
  TimePoint at;              ///< Last known moment; another picture may have followed.
  std::uint64_t number = 0;  ///< Number of the picture at that moment.
};

/// One projector's pictures over time. Late, repeated and disordered reports are sorted by their times; reports older
/// than kKept are dropped, except for the picture that was shown at that time. Only times whose pictures are all known
/// have a result: a missing number means a picture at an unknown time. Thread-bound.
class ShowTimeline {
 public:
  static constexpr Duration kKept = std::chrono::seconds(2);

  ShowTimeline(const calibration::ShowProjector& projector, int factor) : projector_(projector), factor_(factor) {}
  void add(const ShownPicture& shown);
  void known_until(const ShownUntil& until) { until_ = until; }

  struct Exposed {
    LightPlane light;        ///< Mean over the exposure; without pixels if the lamp was off.
    double motion_px = 0.0;  ///< Approximate motion of the content meanwhile, in the plane's pixels.
  };
  /// Returns the light during an exposure; empty if not all of its pictures are known.
  std::optional<Exposed> between(TimePoint opened, TimePoint closed);
  /// True if the shown pictures did not visibly differ from `from` to `until` and, as far as is known, until now. False
  /// if a picture of that time is not known.
  bool is_still(TimePoint from, TimePoint until);

 private:
  struct Entry {
    TimePoint lit_at;
    std::shared_ptr<const RgbImage> picture;
    std::uint64_t number = 0;
    LightPlane light;  ///< Computed at first use.
  };
  using Entries = std::deque<Entry>;
  /// Returns the entries shown between two times; empty if one may be missing.
  [[nodiscard]] std::pair<Entries::iterator, Entries::iterator> shown(TimePoint from, TimePoint until);
  const LightPlane& light_of(Entry* entry);

  calibration::ShowProjector projector_;
  int factor_;
  Entries entries_;
  ShownUntil until_;
};

}  // namespace cyclorama::healing
