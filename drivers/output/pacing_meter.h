// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "drivers/output/output.h"

namespace cyclorama::output {

/// Interval between two successive new pictures on a head.
struct PictureStep {
  Duration interval{};
  /// Refreshes in the interval that repeated the old picture although a new picture was drawn for each of them.
  std::uint64_t missed = 0;
  /// True if the new picture was more than a quarter of a refresh late, but no refresh was missed. This occurs only
  /// without a vertical blank, where a clock sets the pace.
  bool is_late = false;
};

/// Measures how evenly one head gets its pictures. Only consecutive new pictures are compared; there is no pace while
/// nothing new is drawn or the head is dark. A value; thread-bound; allocates nothing.
class PacingMeter {
 public:
  /// Takes the state after a present(). Returns nothing if there is no previous picture to compare with.
  std::optional<PictureStep> take(const HeadShown& shown);

 private:
  std::optional<TimePoint> last_;
};

}  // namespace cyclorama::output
