// SPDX-License-Identifier: Apache-2.0
#include "common/opening/opening_hours.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string_view>

#include "common/base/text.h"

namespace cyclorama {
namespace {

constexpr std::array<std::string_view, 7> kWeekdays{"Mon", "Tue", "Wed", "Thu", "Fri", "Sat", "Sun"};
constexpr int kDay_min = 24 * 60;
constexpr WallTime kEarliest{std::chrono::seconds(1767225600)};  // 2026-01-01.

/// Splits a text. Keeps empty parts, which all callers reject.
std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t at = text.find(separator);
    parts.push_back(text.substr(0, at));
    if (at == std::string_view::npos) return parts;
    text.remove_prefix(at + 1);
  }
}

/// Accepts digits only, unlike parse_integer(), which accepts signs.
std::optional<int> number(std::string_view text, std::size_t digits) {
  const bool is_plain = text.size() == digits && std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
  const auto value = is_plain ? parse_integer(text) : std::nullopt;
  return value ? std::optional(static_cast<int>(*value)) : std::nullopt;
}

std::optional<absl::CivilDay> date(std::string_view text) {
  const auto parts = split(text, '-');
  if (parts.size() != 3) return std::nullopt;
  const auto year = number(parts[0], 4);
  const auto month = number(parts[1], 2);
  const auto day = number(parts[2], 2);
  if (!year || !month || !day) return std::nullopt;
  const absl::CivilDay civil(*year, *month, *day);
  // absl would turn 30 February into 2 March.
  if (civil.month() != *month || civil.day() != *day) return std::nullopt;
  return civil;
}

std::optional<std::size_t> weekday(std::string_view text) {
  const auto found = std::ranges::find(kWeekdays, text);
  if (found == kWeekdays.end()) return std::nullopt;
  return static_cast<std::size_t>(found - kWeekdays.begin());
}

/// Parses texts such as "Mon", "Tue-Sun", "Sat-Mon" and "Mon,Wed-Fri"; empty for any other text.
std::optional<std::array<bool, 7>> weekdays(std::string_view text) {
  std::array<bool, 7> named{};
  for (const std::string_view range : split(text, ',')) {
    const auto ends = split(range, '-');
    const auto from = weekday(ends.front());
    const auto to = weekday(ends.back());
    if (!from || !to || ends.size() > 2) return std::nullopt;
    for (std::size_t day = *from; day != *to; day = (day + 1) % 7) named[day] = true;
    named[*to] = true;
  }
  return named;
}

absl::Time begin_of(const absl::TimeZone::TimeInfo& info) {
  return info.kind == absl::TimeZone::TimeInfo::SKIPPED ? info.trans : info.pre;
}

}  // namespace

bool is_clock_set(WallTime now) { return now >= kEarliest; }

std::optional<int> time_of_day(std::string_view text) {
  const auto parts = split(text, ':');
  if (parts.size() != 2) return std::nullopt;
  const auto hours = number(parts[0], 2);
  const auto minutes = number(parts[1], 2);
  if (!hours || !minutes || *minutes > 59 || 60 * *hours + *minutes > kDay_min) return std::nullopt;
  return 60 * *hours + *minutes;
}

absl::Time end_of(const absl::TimeZone::TimeInfo& info) {
  return info.kind == absl::TimeZone::TimeInfo::SKIPPED ? info.trans : info.post;
}

Result<OpeningHours> OpeningHours::parse(const std::vector<std::string>& lines, const std::string& time_zone) {
  OpeningHours hours;
  hours.is_always_ = false;
  if (lines.empty())
    return Error(ErrorCode::kInvalidArgument, "is empty: it would never open; leave [hours] out to be always open");
  if (time_zone.empty()) {
    hours.zone_ = absl::LocalTimeZone();
  } else if (!absl::LoadTimeZone(time_zone, &hours.zone_)) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("'{}' is no time zone that this computer knows; write one of /usr/share/zoneinfo, such as "
                             "Europe/Zurich, or install Debian's tzdata",
                             printable(time_zone)));
  }
  for (const std::string& line : lines) TRY(hours.add(line));
  return hours;
}

Status OpeningHours::add(const std::string& line) {
  const Error wrong(ErrorCode::kInvalidArgument,
                    fmt::format("'{}': write days and hours, such as \"Tue-Sun 10:00-18:00\", \"Fri,Sat 22:00-02:00\", "
                                "\"2026-12-24 10:00-12:00,13:00-15:00\" or \"2026-12-25 closed\"",
                                printable(line)));
  const auto parts = split(line, ' ');
  if (parts.size() != 2) return wrong;
  std::vector<Span> spans;
  if (parts[1] != "closed") {
    for (const std::string_view range : split(parts[1], ',')) {
      const auto ends = split(range, '-');
      const auto from = time_of_day(ends.front());
      const auto to = time_of_day(ends.back());
      if (ends.size() != 2 || !from || !to || *from == *to || *from == kDay_min) return wrong;
      spans.push_back({*from, *to < *from ? *to + kDay_min : *to});
    }
  }
  const auto append = [&](std::vector<Span>* all) { all->insert(all->end(), spans.begin(), spans.end()); };
  if (const auto day = date(parts[0])) {
    append(&days_[*day]);
  } else if (const auto named = weekdays(parts[0])) {
    for (std::size_t i = 0; i < named->size(); ++i) {
      if ((*named)[i]) append(&week_[i]);
    }
  } else {
    return wrong;
  }
  return Done{};
}

const std::vector<OpeningHours::Span>& OpeningHours::spans_of(absl::CivilDay day) const {
  const auto special = days_.find(day);
  return special != days_.end() ? special->second : week_[static_cast<std::size_t>(absl::GetWeekday(day))];
}

bool OpeningHours::is_open(WallTime now) const {
  if (is_always_ || !is_clock_set(now)) return true;
  const absl::Time time = absl::FromChrono(now);
  const absl::CivilDay today = absl::ToCivilDay(time, zone_);
  for (const absl::CivilDay day : {today - 1, today}) {
    const absl::CivilMinute midnight(day);
    const auto is_within = [&](const Span& span) {
      return begin_of(zone_.At(absl::CivilSecond(midnight + span.from))) <= time &&
             time < end_of(zone_.At(absl::CivilSecond(midnight + span.to)));
    };
    if (std::ranges::any_of(spans_of(day), is_within)) return true;
  }
  return false;
}

OpeningHours read_opening_hours(ConfigTable* site, std::string* ret_time_zone) {
  if (!site->has("hours")) return {};
  ConfigTable table = site->table("hours");
  const std::vector<std::string> lines = table.texts("open");
  const std::string zone = table.text("time_zone", "");
  auto hours = OpeningHours::parse(lines, zone);
  if (hours && ret_time_zone != nullptr) *ret_time_zone = zone;
  if (hours) return *std::move(hours);
  table.refuse("open", hours.error().message());
  return {};
}

Result<OpeningHours> read_opening_hours(const std::filesystem::path& site) {
  TRY_ASSIGN(Config config, Config::read(site));
  ConfigTable root = config.root();
  for (const char* const others : {"display", "farm", "network", "picture", "tour", "update", "walk"})
    static_cast<void>(root.has(others));
  OpeningHours hours = read_opening_hours(&root);
  TRY(config.finish());
  return hours;
}

}  // namespace cyclorama
