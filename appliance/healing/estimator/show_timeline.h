// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <utility>

#include "appliance/healing/estimator/light_plane.h"
#include "common/base/clock.h"

namespace cyclorama::healing {

/// What a projector shone from a moment on: the head's whole picture, as it left the graphics card.
struct ShownPicture {
  std::size_t projector = 0;
  TimePoint lit_at;                         ///< Presentation time and the projector's latency.
  std::shared_ptr<const RgbImage> picture;  ///< Null: the lamp is off.
  std::uint64_t number = 0;                 ///< Grows by one with each that this projector showed, told or not.
};

/// How far it is known what a projector showed.
struct ShownUntil {
  std::size_t projector = 0;
  TimePoint at;              ///< The last moment of which something is known: later, another picture may stand there.
  std::uint64_t number = 0;  ///< Of the picture that stood then.
};

/// What one projector shone, and when. Late, repeated and disordered reports are put where their times say; what is
/// older than kKept is forgotten, but for the picture that was shown then. It answers only for times of which it has
/// been told all: a picture whose number is missing is one of which nobody knows when it came. Thread-bound.
class ShowTimeline {
 public:
  static constexpr Duration kKept = std::chrono::seconds(2);

  ShowTimeline(const calibration::ShowProjector& projector, int factor) : projector_(projector), factor_(factor) {}
  void add(const ShownPicture& shown);
  void known_until(const ShownUntil& until) { until_ = until; }

  struct Exposed {
    LightPlane light;        ///< Mean over the exposure; without pixels, if the lamp was off.
    double motion_px = 0.0;  ///< How far content moved during it, about, in the plane's pixels.
  };
  /// Nothing when it is not known what was shown all the time.
  std::optional<Exposed> between(TimePoint opened, TimePoint closed);
  /// Whether one picture stood from `from` to `until` and ever since, as far as it is known, or pictures that differ by
  /// less than a camera tells. False where it is not known.
  bool is_still(TimePoint from, TimePoint until);

 private:
  struct Entry {
    TimePoint lit_at;
    std::shared_ptr<const RgbImage> picture;
    std::uint64_t number = 0;
    LightPlane light;  ///< Made when first asked for.
  };
  using Entries = std::deque<Entry>;
  /// Those that were shown between two times; empty where one may be missing.
  [[nodiscard]] std::pair<Entries::iterator, Entries::iterator> shown(TimePoint from, TimePoint until);
  const LightPlane& light_of(Entry* entry);

  calibration::ShowProjector projector_;
  int factor_;
  Entries entries_;
  ShownUntil until_;
};

}  // namespace cyclorama::healing
