// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "appliance/healing/estimator/show_timeline.h"
#include "appliance/scan/remote_pattern_screen.h"

namespace cyclorama::healing {

/// Retrieves the pictures that remote displays showed, through the service ShownPictures (common/wire/show.proto).
/// Times are of this computer's clock; each reply updates the offset to the display's clock (ClockOffset).
/// Thread-bound.
class RemoteShown {
 public:
  /// Connects to the displays. `latency` is the time from a projector's signal to its light. Errors: kInvalidArgument
  /// if a projector belongs to no display, or to two.
  static Result<std::unique_ptr<RemoteShown>> open(const std::vector<InstalledProjector>& projectors,
                                                   const std::vector<scan::PatternDisplay>& displays, int factor,
                                                   Duration latency, const Clock& clock);
  ~RemoteShown();
  RemoteShown(const RemoteShown&) = delete;
  RemoteShown& operator=(const RemoteShown&) = delete;

  struct Shown {
    std::vector<ShownPicture> pictures;  ///< Pictures that were not returned before.
    std::vector<ShownUntil> until;       ///< One per projector.
    /// True if all heads displayed the show throughout, and the displays' clocks are known to kTimeDoubt / 2; otherwise
    /// nothing can be compared.
    bool is_show = true;
  };
  /// Returns the pictures that were lit from shortly before `opened` until shortly after `closed`; waits some refreshes
  /// until the displays have recorded them. Errors: kUnavailable, kTimedOut if a display cannot be reached or does not
  /// refresh, with its address.
  Result<Shown> between(TimePoint opened, TimePoint closed);

 private:
  class Display;
  RemoteShown(Duration latency, const Clock& clock);

  std::vector<std::unique_ptr<Display>> displays_;
  Duration latency_;
  const Clock& clock_;
};

}  // namespace cyclorama::healing
