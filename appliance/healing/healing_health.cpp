// SPDX-License-Identifier: Apache-2.0
#include "appliance/healing/healing_health.h"

#include <fmt/format.h>

#include <algorithm>

namespace cyclorama::healing {
namespace {

void add_columns(wire::Table* table, std::initializer_list<const char*> names) {
  for (const char* name : names) table->add_columns(name);
}
void add(wire::Row* row, std::string text) { row->add_cells()->set_text(std::move(text)); }
void add(wire::Row* row, double number) { row->add_cells()->set_number(number); }

}  // namespace

void HealingHealth::take(const ShowReport& report, TimePoint now) {
  health_ = report.projectors;
  for (const Correction& correction : report.corrections) {
    Last& last = last_[correction.projector];
    ++last.corrections;
    last.moved_px = pixels_ * correction.moved_px;
    last.at = now;
  }
  // A large displacement must appear in the plot, however soon it was corrected.
  if (!history_.empty() && now - history_.back().at < kEvery && report.corrections.empty()) return;
  Sample sample;
  sample.at = now;
  for (std::size_t i = 0; i < names_.size() && i < health_.size(); ++i) {
    const bool is_known = health_[i].hold == HoldReason::kNone || health_[i].hold == HoldReason::kInTheWay;
    sample.off_px.push_back(is_known ? std::optional(pixels_ * health_[i].off_px) : std::nullopt);
  }
  for (const Correction& correction : report.corrections)
    sample.off_px[correction.projector] = pixels_ * correction.moved_px;
  history_.push_back(std::move(sample));
  if (history_.size() > kMaxSamples) history_.pop_front();
}

wire::Table HealingHealth::projectors(TimePoint now) const {
  wire::Table table;
  table.set_name("watched projectors");
  add_columns(&table, {"projector", "state", "reason", "off_px", "sigma_px", "corrections", "last_correction_px",
                       "last_correction_s", "wants_scan"});
  for (std::size_t i = 0; i < names_.size() && i < health_.size(); ++i) {
    const ProjectorHealth& one = health_[i];
    wire::Row* const row = table.add_rows();
    add(row, names_[i]);
    add(row, std::string(name_of(one.hold)));
    add(row, one.reason);
    add(row, pixels_ * one.off_px);
    add(row, pixels_ * one.sigma_px);
    add(row, last_[i].corrections);
    if (last_[i].corrections > 0) {
      add(row, last_[i].moved_px);
      add(row, to_seconds(now - last_[i].at));
    } else {
      row->add_cells();
      row->add_cells();
    }
    add(row, one.wants_scan ? 1.0 : 0.0);
  }
  return table;
}

wire::Table HealingHealth::history(TimePoint now) const {
  wire::Table table;
  table.set_name("watched history");
  add_columns(&table, {"s"});
  for (const std::string& name : names_) table.add_columns(name);
  for (const Sample& sample : history_) {
    wire::Row* const row = table.add_rows();
    add(row, to_seconds(now - sample.at));
    for (const auto& off_px : sample.off_px) {
      wire::Cell* const cell = row->add_cells();
      if (off_px) cell->set_number(*off_px);
    }
  }
  return table;
}

std::string HealingHealth::sentence() const {
  std::string held;
  std::size_t good = 0;
  for (std::size_t i = 0; i < names_.size() && i < health_.size(); ++i) {
    const ProjectorHealth& one = health_[i];
    if (one.hold == HoldReason::kNone) {
      ++good;
      continue;
    }
    if (!held.empty()) held += "; ";
    held += fmt::format("'{}' is left as it is: {}", names_[i], one.reason);
    if (one.wants_scan) held += "; scan the wall when the museum is closed";
  }
  if (health_.empty()) return "begins to watch the wall";
  if (held.empty()) return fmt::format("keeps {} projectors in place", good);
  return good == 0 ? held : fmt::format("keeps {} of {} projectors in place; {}", good, names_.size(), held);
}

bool HealingHealth::is_well() const {
  return std::ranges::none_of(health_, [](const ProjectorHealth& one) { return one.wants_scan; });
}

}  // namespace cyclorama::healing
