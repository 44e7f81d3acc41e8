// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "drivers/output/output.h"

namespace cyclorama::output {

/// From one new picture to the next one on a head.
struct PictureStep {
  Duration interval{};
  std::uint64_t missed = 0;  ///< Refreshes between them that showed the old one, though a new one was drawn for each.
  /// More than a quarter of a refresh late, and none missed: only where a clock paces and no raster.
  bool is_late = false;
};

/// How evenly one head gets its pictures. Only those that follow one another are compared: while nothing new is drawn,
/// or the head is dark, there is no pace. A value; thread-bound; allocates nothing.
class PacingMeter {
 public:
  /// What the head did at a present(). Nothing when there is nothing to compare with.
  std::optional<PictureStep> take(const HeadShown& shown);

 private:
  std::optional<TimePoint> last_;
};

}  // namespace cyclorama::output
