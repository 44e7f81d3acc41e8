// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kiosk/care/visit_counts.h"
#include "kiosk/operator/checks.h"
#include "kiosk/operator/observation.h"

namespace cyclorama::operations {

/// Returns metrics in Prometheus' text format 0.0.4. It needs no metrics registry, since the processes keep all
/// numbers.
///
///   cyclorama_up{process}  cyclorama_healthy{process}  cyclorama_uptime_seconds{process}
///   cyclorama_stage_seconds{process,stage,quantile} and cyclorama_stage_seconds_count{process,stage}
///   cyclorama_dropped_frames_total{process,reason}
///   cyclorama_gauge{process,name}   every other gauge; its unit is in its name
///
/// A process that is away has only cyclorama_up, so that no old number looks new.
[[nodiscard]] std::string metrics_text(const std::vector<ProcessObservation>& observations);

/// Returns the metrics of the museum itself:
///
///   cyclorama_checks{level}         number of checks that are ok, a warning or a fault
///   cyclorama_visits_total, cyclorama_visit_seconds_total       counts alone (VisitCounts)
[[nodiscard]] std::string museum_metrics_text(const std::vector<Check>& checks, const care::VisitCounts::Day& visits);

}  // namespace cyclorama::operations
