// SPDX-License-Identifier: Apache-2.0
#include "common/opening/hours_override.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "common/base/file.h"
#include "common/base/text.h"

namespace cyclorama {
namespace {

using std::chrono::floor;
using std::chrono::seconds;

constexpr std::size_t kMaxFileBytes = 200;
constexpr auto kMaxLookAhead = std::chrono::hours(18);
constexpr int kMaxDays = 8;
constexpr const char* kTime = "%E4Y-%m-%dT%H:%M:%SZ";

std::string time_text(WallTime time) { return absl::FormatTime(kTime, absl::FromChrono(time), absl::UTCTimeZone()); }

std::optional<WallTime> time_of(std::string_view text) {
  absl::Time time;
  std::string error;
  if (!absl::ParseTime(kTime, std::string(text), &time, &error)) return std::nullopt;
  const absl::CivilDay day = absl::ToCivilDay(time, absl::UTCTimeZone());
  if (day.year() < 2000 || day.year() > 2200) return std::nullopt;  // "infinite-future" also parses as a time.
  return floor<seconds>(absl::ToChronoTime(time));
}

bool is_sound(const HoursOverride& override) {
  return override.set_at < override.until && override.until - override.set_at <= kMaxOverrideDuration;
}

Error not_set() {
  return {ErrorCode::kUnavailable,
          "this computer's clock was never set, so nothing can end by it; connect the network, and try again"};
}

}  // namespace

std::string to_text(const HoursOverride& override) {
  return fmt::format("{} from {} until {}\n", override.is_open ? "open" : "closed", time_text(override.set_at),
                     time_text(override.until));
}

Result<HoursOverride> parse_hours_override(std::string_view text) {
  const Error bad(ErrorCode::kBadData, "the override of the opening hours is damaged and is ignored");
  if (text.size() > kMaxFileBytes) return bad;
  HoursOverride override;
  override.is_open = text.starts_with("open from ");
  const std::size_t from = text.find(" from ");
  const std::size_t until = text.find(" until ");
  if (from == std::string_view::npos || until == std::string_view::npos || until < from + 6) return bad;
  std::string_view last = text.substr(until + 7);
  if (last.ends_with('\n')) last.remove_suffix(1);
  const auto set_at = time_of(text.substr(from + 6, until - from - 6));
  const auto ends_at = time_of(last);
  if (!set_at || !ends_at) return bad;
  override.set_at = *set_at;
  override.until = *ends_at;
  // Rejects other forms that ParseTime accepts.
  if (!is_sound(override) || to_text(override) != text) return bad;
  return override;
}

Result<std::optional<HoursOverride>> read_hours_override(const std::filesystem::path& file) {
  const auto text = read_text_file(file, kMaxFileBytes);
  if (!text && text.error().code() == ErrorCode::kNotFound) return std::optional<HoursOverride>();
  if (!text) return text.error();
  TRY_ASSIGN(const HoursOverride override, parse_hours_override(*text));
  return std::optional(override);
}

Result<HoursOverride> open_until(const OpeningHours& hours, std::string_view time, WallTime now) {
  if (!is_clock_set(now)) return not_set();
  const std::optional<int> minute = time_of_day(time);
  if (!minute) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("'{}' is no time of day; write one such as 22:00", printable(time, 20)));
  }
  const absl::CivilDay today = absl::ToCivilDay(absl::FromChrono(now), hours.zone());
  for (const absl::CivilDay day : {today, today + 1}) {
    const absl::Time end = end_of(hours.zone().At(absl::CivilSecond(absl::CivilMinute(day) + *minute)));
    const WallTime until = floor<seconds>(absl::ToChronoTime(end));
    if (until <= now) continue;
    if (until - now > kMaxLookAhead) break;
    return HoursOverride{true, floor<seconds>(now), until};
  }
  return Error(ErrorCode::kInvalidArgument,
               fmt::format("{} is over for today; say a time that is at most 18 hours ahead", time));
}

Result<HoursOverride> closed_for_today(const OpeningHours& hours, WallTime now) {
  if (!is_clock_set(now)) return not_set();
  const absl::CivilDay tomorrow = absl::ToCivilDay(absl::FromChrono(now), hours.zone()) + 1;
  const WallTime midnight = floor<seconds>(absl::ToChronoTime(absl::FromCivil(tomorrow, hours.zone())));
  constexpr auto kMinute = std::chrono::minutes(1);
  HoursOverride override{false, floor<seconds>(now), midnight};
  // Hours that continue past midnight belong to the day before.
  bool was_open = hours.is_open(midnight - kMinute);
  for (WallTime time = midnight; time < midnight + std::chrono::hours(24 * kMaxDays); time += kMinute) {
    const bool is_open = hours.is_open(time);
    if (is_open && !was_open) {
      override.until = time;
      break;
    }
    was_open = is_open;
  }
  return override;
}

bool is_open(const OpeningHours& hours, const std::optional<HoursOverride>& override, WallTime now) {
  return override && override->holds(now) ? override->is_open : hours.is_open(now);
}

bool OverriddenHours::is_open(WallTime now) {
  if (!file_.empty() && (!read_at_ || now < *read_at_ || now >= *read_at_ + seconds(1))) {
    read_at_ = now;
    auto read = read_hours_override(file_);
    override_ = read ? *std::move(read) : std::nullopt;
  }
  return cyclorama::is_open(hours_, override_, now);
}

}  // namespace cyclorama
