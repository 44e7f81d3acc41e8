// SPDX-License-Identifier: Apache-2.0
/// What the operator knows about one process now.
#pragma once

#include <optional>
#include <string>

#include "common/wire/inspection.pb.h"
#include "kiosk/operator/process_link.h"

namespace cyclorama {

struct Observation {
  Endpoint endpoint;
  bool asked = false;                         ///< False until the first answer, or the first failure.
  bool away = true;                           ///< It did not answer the last time.
  std::string sentence;                       ///< Its own state, or what its absence means and what helps.
  std::optional<wire::ProcessStatus> status;  ///< The newest that ever came, also when it is away now.

  [[nodiscard]] bool is_well() const { return asked && !away && status->healthy(); }
};

/// Asks now; blocks as ProcessLink::status(). `last` gives the status that is kept while the process is away.
[[nodiscard]] Observation observe(const ProcessLink& link, const Observation& last);

/// The newest value, or nothing.
[[nodiscard]] std::optional<double> gauge_of(const wire::ProcessStatus& status, std::string_view name);
[[nodiscard]] std::string fact_of(const wire::ProcessStatus& status, std::string_view name);

}  // namespace cyclorama
