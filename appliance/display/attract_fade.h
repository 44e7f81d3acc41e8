// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/clock.h"

namespace cyclorama::display {

struct AttractTimes {
  Duration after = std::chrono::seconds(20);  ///< Time for which a wrong picture stays before it fades.
  /// Duration of the fade from one picture to the other; at least a millisecond.
  Duration fade = std::chrono::seconds(2);
};

/// Share of the attract picture in what the heads show. A picture that is wrong (the visitor has turned and no frame
/// follows, the tour is gone, or frames fail) stays for AttractTimes::after and then fades to the attract picture; the
/// next frame fades in. The share never jumps, however late a refresh is.
///
///          wrong for `after`
///   frame ──────────────────► fading ──► attract        Thread-bound; allocates nothing.
///     ▲ ◄─────────────────────── │ ◄──────── │
///               a frame          (from where it is)
class AttractFade {
 public:
  explicit AttractFade(const AttractTimes& times) : times_(times) {}

  /// Called once per refresh. `is_new_frame`: this refresh shows a frame for the first time; `is_wrong`: the picture on
  /// the wall is not the one that should be there.
  void step(TimePoint now, bool is_new_frame, bool is_wrong);
  /// Share of the attract picture in [0, 1]; 1 until the first frame.
  [[nodiscard]] double share() const;
  [[nodiscard]] bool is_towards_attract() const { return is_attracting_; }

 private:
  AttractTimes times_;
  double progress_ = 1.0;
  bool is_attracting_ = true;
  TimePoint last_step_{};
  TimePoint right_at_{};
};

}  // namespace cyclorama::display
