// SPDX-License-Identifier: Apache-2.0
/// Decides whether a museum that has just started works well enough to keep this version of its software.
///
///   check, check, check ... ──▶ `looks` good checks in a row: keep it    deadline passes: give it up, with the reasons
///
/// Only conditions that depend on the software count: a farm or network that is away, or an unplugged camera, is no
/// reason to return to an older version.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "kiosk/operator/observation.h"

namespace cyclorama::operations {

struct HealthRules {
  std::vector<std::string> well;  ///< Processes that must report that they are healthy, besides answering.
  int heads = 1;                  ///< Minimum number of heads of all displays together.
  int looks = 3;                  ///< Number of consecutive checks that must find nothing wrong.
  /// Heads that were dark before the restart: their projectors may still be off. Their pictures are checked
  /// nevertheless.
  std::set<std::string> may_be_dark;
};

/// Input of the rules: the processes, and the available pictures of the heads, by process and name.
struct HealthSnapshot {
  std::vector<ProcessObservation> processes;
  std::map<std::pair<std::string, std::string>, bool> is_blank;  ///< Without the pictures that could not be fetched.
};

/// Returns one sentence for each condition that is not met yet; none when all are. Pure.
///   1. Every process answers.
///   2. The processes in `well` are healthy.
///   3. No display has lost its output; each of its heads has a picture, and is lit, unless the display sleeps because
///      the museum is closed: then it draws for heads that are dark.
[[nodiscard]] std::vector<std::string> still_missing(const HealthSnapshot& look, const HealthRules& rules);

/// Counts good checks in a row. A process that restarted since the previous check resets the count, since a
/// process that dies every few seconds answers most of the time. A value.
class HealthCount {
 public:
  explicit HealthCount(HealthRules rules) : rules_(std::move(rules)) {}
  void take(const HealthSnapshot& look);
  [[nodiscard]] bool is_well() const { return in_a_row_ >= rules_.looks; }
  /// Unmet conditions of the newest check.
  [[nodiscard]] const std::vector<std::string>& missing() const { return missing_; }

 private:
  HealthRules rules_;
  int in_a_row_ = 0;
  std::map<std::string, double> uptimes_s_;
  std::vector<std::string> missing_{"nothing has been looked at yet"};
};

/// Queries every process, then every display for its heads' pictures. Blocks like ProcessLink's calls.
[[nodiscard]] HealthSnapshot look_at(const std::vector<ProcessLink>& links);

/// Returns the heads of all displays that are dark now, asleep or without a projector.
[[nodiscard]] std::set<std::string> dark_heads(const HealthSnapshot& look);

/// Returns {"well", "seconds", "version", "missing": [sentence]}, for the operator page.
[[nodiscard]] std::string health_json(const HealthCount& count, double seconds);

}  // namespace cyclorama::operations
