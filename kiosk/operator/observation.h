// SPDX-License-Identifier: Apache-2.0
/// The operator's present information about one process.
#pragma once

#include <optional>
#include <string>

#include "common/wire/inspection.pb.h"
#include "kiosk/operator/process_link.h"

namespace cyclorama::operations {

struct ProcessObservation {
  Endpoint endpoint;
  bool asked = false;    ///< False until the first answer or the first failure.
  bool away = true;      ///< True when the last request failed.
  std::string sentence;  ///< The process's own state, or the meaning of its absence and the remedy.
  std::optional<wire::ProcessStatus> status;  ///< Newest status received, kept while the process is away.

  [[nodiscard]] bool is_well() const { return asked && !away && status->healthy(); }
};

/// Queries the process; blocks like ProcessLink::status(). `last` supplies the status to keep while the process is
/// away.
[[nodiscard]] ProcessObservation observe(const ProcessLink& link, const ProcessObservation& last);

/// Returns the newest value, or nothing.
[[nodiscard]] std::optional<double> gauge_of(const wire::ProcessStatus& status, std::string_view name);
[[nodiscard]] std::string fact_of(const wire::ProcessStatus& status, std::string_view name);

}  // namespace cyclorama::operations
