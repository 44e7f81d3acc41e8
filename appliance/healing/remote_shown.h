// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "appliance/healing/estimator/show_timeline.h"
#include "appliance/scan/remote_pattern_screen.h"

namespace cyclorama::healing {

/// Retrieves what remote displays showed, by the service ShownPictures (common/wire/show.proto), in this computer's
/// time; each reply updates the offset to the display's clock (ClockOffset). Thread-bound.
class RemoteShown {
 public:
  /// `latency`: from a projector's signal to its light. Errors: kInvalidArgument if a projector belongs to no display,
  /// or to two.
  static Result<std::unique_ptr<RemoteShown>> open(const std::vector<InstalledProjector>& projectors,
                                                   const std::vector<scan::PatternDisplay>& displays, int factor,
                                                   Duration latency, const Clock& clock);
  ~RemoteShown();
  RemoteShown(const RemoteShown&) = delete;
  RemoteShown& operator=(const RemoteShown&) = delete;

  struct Shown {
    std::vector<ShownPicture> pictures;  ///< Pictures that were not returned before.
    std::vector<ShownUntil> until;       ///< One per projector.
    /// All heads displayed the show throughout, and the displays' clocks are known to kTimeDoubt / 2; otherwise nothing
    /// can be compared.
    bool is_show = true;
  };
  /// Returns what was lit at `opened`, and what came until `closed` and a little after it; waits some refreshes until
  /// the displays have recorded it. Errors: kUnavailable, kTimedOut if a display cannot be reached, or does not
  /// refresh, with its name.
  Result<Shown> between(TimePoint opened, TimePoint closed);

 private:
  class Display;
  RemoteShown(Duration latency, const Clock& clock);

  std::vector<std::unique_ptr<Display>> displays_;
  Duration latency_;
  const Clock& clock_;
};

}  // namespace cyclorama::healing
