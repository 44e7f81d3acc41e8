// SPDX-License-Identifier: Apache-2.0
/// Civil time, as far as it is known. A computer with an empty clock battery starts with a time in the distant past,
/// which its software replaces with the newest time that it has recorded. Until a time server has answered, that time
/// must not open, close or restart anything. The appliance's image creates the file `lost` if its hardware clock shows
/// a time before the image was made.
#pragma once

#include <filesystem>

#include "common/opening/opening_hours.h"

namespace cyclorama {

struct ClockMarks {
  std::filesystem::path lost = "/run/cyclorama/clock-lost";
  std::filesystem::path synchronized = "/run/systemd/timesync/synchronized";  ///< Created by systemd-timesyncd.
};

/// Returns `now` or, while the clock is lost, a time in 1970, at which OpeningHours is open and no update is due.
/// Thread-safe.
[[nodiscard]] WallTime wall_time(WallTime now, const ClockMarks& marks = {});

}  // namespace cyclorama
