// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/session/display_roster.h"

#include <algorithm>
#include <cmath>

#include "common/base/text.h"

namespace cyclorama::tour {
namespace {

void add_number(wire::Row* row, std::optional<double> number) {
  wire::Cell* const cell = row->add_cells();
  if (number && std::isfinite(*number)) cell->set_number(*number);
}

}  // namespace

void DisplayRoster::joined(std::uint64_t display, const wire::DisplayHello& hello) {
  const std::lock_guard lock(mutex_);
  members_[display].hello = hello;
}

void DisplayRoster::left(std::uint64_t display) {
  const std::lock_guard lock(mutex_);
  members_.erase(display);
}

void DisplayRoster::heard(std::uint64_t display, const wire::ClockRequest& question) {
  const std::lock_guard lock(mutex_);
  const auto found = members_.find(display);
  if (found == members_.end()) return;
  found->second.newest = question;
  if (question.frame_need_s() > 0.0) found->second.frame_need_s = question.frame_need_s();
}

std::optional<double> DisplayRoster::synchronised_share() const {
  const std::lock_guard lock(mutex_);
  int known = 0;
  double min = 1.0;
  for (const auto& [id, member] : members_) {
    const double share = member.newest.synchronised_share();
    if (!member.newest.has_synchronised_share() || !(share >= 0.0 && share <= 1.0)) continue;
    ++known;
    min = std::min(min, share);
  }
  return known > 1 ? std::optional(min) : std::nullopt;
}

wire::Table DisplayRoster::table() const {
  const std::lock_guard lock(mutex_);
  wire::Table table;
  table.set_name("displays");
  for (const char* const column :
       {"name", "heads", "refresh_hz", "synchronised_percent", "clock_skew_ms", "clock_error_ms", "frame_need_ms"}) {
    table.add_columns(column);
  }
  for (const auto& [id, member] : members_) {
    const wire::ClockRequest& newest = member.newest;
    const bool has_skew = newest.has_skew_s();
    wire::Row* const row = table.add_rows();
    row->add_cells()->set_text(printable(member.hello.name()));
    add_number(row, member.hello.heads());
    add_number(row, member.hello.refresh_hz());
    add_number(row,
               newest.has_synchronised_share() ? std::optional(100.0 * newest.synchronised_share()) : std::nullopt);
    add_number(row, has_skew ? std::optional(1e3 * newest.skew_s()) : std::nullopt);
    add_number(row, has_skew ? std::optional(1e3 * newest.skew_error_s()) : std::nullopt);
    add_number(row, member.frame_need_s > 0.0 ? std::optional(1e3 * member.frame_need_s) : std::nullopt);
  }
  return table;
}

}  // namespace cyclorama::tour
