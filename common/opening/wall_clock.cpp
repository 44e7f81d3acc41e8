// SPDX-License-Identifier: Apache-2.0
#include "common/opening/wall_clock.h"

#include <system_error>

namespace cyclorama {

WallTime wall_time(WallTime now, const ClockMarks& marks) {
  std::error_code error;
  const bool is_lost =
      std::filesystem::exists(marks.lost, error) && !std::filesystem::exists(marks.synchronized, error);
  return is_lost ? WallTime{} : now;
}

}  // namespace cyclorama
