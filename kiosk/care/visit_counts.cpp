// SPDX-License-Identifier: Apache-2.0
#include "kiosk/care/visit_counts.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "common/json/strict_json.h"

namespace cyclorama::care {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kCountsVersion = 1;
constexpr std::chrono::seconds kVisitEnds{60};
constexpr std::chrono::seconds kMinVisit{5};
constexpr int kMaxVisits = 1'000'000'000;
constexpr double kMaxSeconds = 1e12;
constexpr std::size_t kDateLength = 10;

Json day_json(const VisitCounts::Day& day) { return {{"visits", day.visits}, {"seconds", day.seconds}}; }

VisitCounts::Day read_day(StrictJson json) {
  VisitCounts::Day day{json.integer("visits", 0, kMaxVisits), json.number("seconds", 0.0, kMaxSeconds)};
  return day;
}

}  // namespace

void VisitCounts::update(bool is_steered, WallSeconds now, const std::string& day) {
  if (began_ && now < steered_) began_.reset();  // The clock was set back in the middle of a visit.
  if (is_steered) {
    if (!began_) began_ = now;
    steered_ = now;
    return;
  }
  if (!began_ || now - steered_ < kVisitEnds) return;
  const auto lasted = steered_ - *began_;
  began_.reset();
  if (lasted < kMinVisit) return;
  for (Day* const sum : {&days_[day], &total_}) {
    ++sum->visits;
    sum->seconds += static_cast<double>(lasted.count());
  }
  if (days_.size() > kMaxDays) days_.erase(days_.begin());
}

std::string VisitCounts::to_json() const {
  Json days = Json::array();
  for (const auto& [date, day] : days_) {
    Json one = day_json(day);
    one["date"] = date;
    days.push_back(std::move(one));
  }
  return Json{{"version", kCountsVersion}, {"total", day_json(total_)}, {"days", std::move(days)}}.dump(1) + "\n";
}

Status VisitCounts::read_json(std::string_view text, const std::string& name) {
  constexpr const char* kRemedy = "remove it; the counts then begin anew";
  TRY_ASSIGN(const nlohmann::json document, parse_document(text, name, kRemedy));
  StrictJson::Mistakes mistakes(kRemedy);
  StrictJson root(document, &mistakes);
  root.require_version(kCountsVersion);
  const Day total = read_day(root.at("total"));
  std::map<std::string, Day> days;
  for (StrictJson& one : root.list("days", 0, kMaxDays)) {
    const std::string date = one.text("date", kDateLength);
    days[date] = read_day(one);
  }
  root.refuse_other_keys();
  TRY(mistakes.status(name));
  days_ = std::move(days);
  total_ = total;
  return Done{};
}

}  // namespace cyclorama::care
