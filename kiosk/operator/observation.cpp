// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/observation.h"

#include "common/base/text.h"

namespace cyclorama::operations {

ProcessObservation observe(const ProcessLink& link, const ProcessObservation& last) {
  ProcessObservation now;
  now.endpoint = link.endpoint();
  now.asked = true;
  auto status = link.status();
  now.away = !status.has_value();
  if (status) {
    now.sentence = printable(status->state(), 500);
    now.status = *std::move(status);
  } else {
    now.sentence = away_sentence(now.endpoint, status.error());
    now.status = last.status;
  }
  return now;
}

std::optional<double> gauge_of(const wire::ProcessStatus& status, std::string_view name) {
  for (const wire::Gauge& gauge : status.gauges()) {
    if (gauge.name() == name) return gauge.value();
  }
  return std::nullopt;
}

std::string fact_of(const wire::ProcessStatus& status, std::string_view name) {
  for (const wire::Fact& fact : status.facts()) {
    if (fact.name() == name) return fact.value();
  }
  return "";
}

}  // namespace cyclorama::operations
