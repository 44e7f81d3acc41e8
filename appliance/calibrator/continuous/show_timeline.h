// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <memory>
#include <optional>

#include "appliance/calibrator/continuous/light_plane.h"
#include "common/base/clock.h"

namespace cyclorama {

/// What a projector shone from a moment on: the head's whole picture, as it left the graphics card.
struct ShownPicture {
  std::size_t projector = 0;
  TimePoint lit_at;                         ///< Presentation time and the projector's latency.
  std::shared_ptr<const RgbImage> picture;  ///< Null: the lamp is off.
};

/// What one projector shone, and when. Late, repeated and disordered reports are put where their times say; what is
/// older than kKept is forgotten, but for the picture that was shown then. Thread-bound.
class ShowTimeline {
 public:
  static constexpr Duration kKept = std::chrono::seconds(2);

  ShowTimeline(const ShowProjector& projector, int factor) : projector_(projector), factor_(factor) {}
  void add(const ShownPicture& shown);

  struct Exposed {
    LightPlane light;        ///< Mean over the exposure; without pixels, if the lamp was off.
    double motion_px = 0.0;  ///< How far content moved during it, about, in the plane's pixels.
  };
  /// Nothing when it is not known what was shown all the time.
  std::optional<Exposed> between(TimePoint opened, TimePoint closed);

 private:
  struct Entry {
    TimePoint lit_at;
    std::shared_ptr<const RgbImage> picture;
    LightPlane light;  ///< Made when first asked for.
  };
  const LightPlane& light_of(Entry* entry);

  ShowProjector projector_;
  int factor_;
  std::deque<Entry> entries_;
};

}  // namespace cyclorama
