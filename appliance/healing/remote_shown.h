// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "appliance/healing/estimator/show_timeline.h"
#include "appliance/scan/remote_pattern_screen.h"

namespace cyclorama::healing {

/// What displays elsewhere showed, by the service ShownPictures (common/wire/show.proto), on this computer's clock; how
/// it differs from theirs each answer tells (ClockOffset). Thread-bound.
class RemoteShown {
 public:
  /// `latency`: from a projector's signal to its light.
  /// kInvalidArgument  a projector belongs to no display, or to two.
  static Result<std::unique_ptr<RemoteShown>> open(const std::vector<InstalledProjector>& projectors,
                                                   const std::vector<scan::PatternDisplay>& displays, int factor,
                                                   Duration latency, const Clock& clock);
  ~RemoteShown();
  RemoteShown(const RemoteShown&) = delete;
  RemoteShown& operator=(const RemoteShown&) = delete;

  struct Shown {
    std::vector<ShownPicture> pictures;  ///< That were not told before.
    std::vector<ShownUntil> until;       ///< Of each projector.
    /// All the time, on all heads, and the displays' clocks are known to kTimeDoubt / 2: else nothing can be compared.
    bool is_show = true;
  };
  /// What was lit at `opened`, and what came until `closed` and a little after it; waits some refreshes for the
  /// displays to know.
  /// kUnavailable, kTimedOut  a display cannot be reached, or does not refresh: says which.
  Result<Shown> between(TimePoint opened, TimePoint closed);

 private:
  class Display;
  RemoteShown(Duration latency, const Clock& clock);

  std::vector<std::unique_ptr<Display>> displays_;
  Duration latency_;
  const Clock& clock_;
};

}  // namespace cyclorama::healing
