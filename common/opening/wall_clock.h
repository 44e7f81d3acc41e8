// SPDX-License-Identifier: Apache-2.0
/// What time it is, as far as that is known. A computer whose clock's battery is empty begins with a time of long ago,
/// which its software takes for the newest that it knows of; until a time server has answered, nobody may open, close
/// or start again by it. The appliance's image makes the mark `lost` when its hardware's clock tells a time before the
/// image was made.
#pragma once

#include <filesystem>

#include "common/opening/opening_hours.h"

namespace cyclorama {

struct ClockMarks {
  std::filesystem::path lost = "/run/cyclorama/clock-lost";
  std::filesystem::path synchronized = "/run/systemd/timesync/synchronized";  ///< systemd-timesyncd makes it.
};

/// `now`; or 1970, which OpeningHours takes for open and updates for no night, while the clock is lost. Thread-safe.
[[nodiscard]] WallTime wall_time(WallTime now, const ClockMarks& marks = {});

}  // namespace cyclorama
