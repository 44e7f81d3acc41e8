// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/status_table.h"

#include <fmt/format.h>

#include <iterator>

#include "kiosk/operator/frame_stages.h"

namespace cyclorama::operations {
namespace {

const char* word_for(const ProcessObservation& observation) {
  if (observation.away) return "away";
  return observation.is_well() ? "well" : "needs you";
}

void append_stages(const wire::ProcessStatus& tour, std::string* table) {
  const auto out = std::back_inserter(*table);
  if (tour.stages().empty()) return;
  fmt::format_to(out, "\n{:<22}{:>10}{:>10}{:>10}{:>9}\n", "from shutter to photon", "p50 ms", "p95 ms", "p99 ms",
                 "count");
  for (const wire::Stage& stage : in_frame_order(tour)) {
    fmt::format_to(out, "{:<22}{:>10.1f}{:>10.1f}{:>10.1f}{:>9}\n", stage.name(), stage.p50_ms(), stage.p95_ms(),
                   stage.p99_ms(), stage.count());
  }
}

}  // namespace

std::string status_table(const std::vector<ProcessObservation>& observations) {
  std::string table;
  for (const ProcessObservation& observation : observations) {
    fmt::format_to(std::back_inserter(table), "{:<16}{:<10} {}\n", observation.endpoint.name, word_for(observation),
                   observation.sentence);
    if (observation.away || observation.status->pictures().empty()) continue;
    fmt::format_to(std::back_inserter(table), "{:<27}pictures: {}\n", "",
                   fmt::join(observation.status->pictures(), ", "));
  }
  for (const ProcessObservation& observation : observations) {
    if (observation.endpoint.name == "tour" && observation.status) append_stages(*observation.status, &table);
  }
  return table;
}

std::string status_table_of(const Recording& recording, const RecordedSpan& span) {
  std::vector<ProcessObservation> observations;
  for (const RecordedProcess& process : recording.processes()) observations.push_back(process.last);
  return fmt::format("{}\n{:.0f} frames in {:.1f} s: {:.1f} frames a second\n", status_table(observations), span.frames,
                     span.seconds, span.seconds > 0.0 ? span.frames / span.seconds : 0.0);
}

}  // namespace cyclorama::operations
