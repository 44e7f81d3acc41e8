// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/synchronised_share.h"

#include <algorithm>

namespace cyclorama::display {
namespace {
std::int64_t second_of(TimePoint t) {
  return std::chrono::duration_cast<std::chrono::seconds>(t.time_since_epoch()).count();
}
}  // namespace

void SynchronisedShare::add(TimePoint now, std::int64_t refreshes, std::int64_t late) {
  const std::int64_t number = second_of(now);
  Second& second = seconds_[static_cast<std::size_t>(number % kSeconds)];
  if (second.number != number) second = {number, 0, 0};
  second.refreshes += refreshes;
  second.late += late;
}

std::optional<double> SynchronisedShare::share(TimePoint now) const {
  const std::int64_t number = second_of(now);
  std::int64_t refreshes = 0;
  std::int64_t late = 0;
  for (const Second& second : seconds_) {
    if (second.number < 0 || number - second.number >= kSeconds) continue;
    refreshes += second.refreshes;
    late += second.late;
  }
  if (refreshes == 0) return std::nullopt;
  return 1.0 - static_cast<double>(std::min(late, refreshes)) / static_cast<double>(refreshes);
}

}  // namespace cyclorama::display
