// SPDX-License-Identifier: Apache-2.0
/// Whether a museum that has just started works well enough for this version of its software to be kept.
///
///   look, look, look ... ──▶ well `looks` times in a row: keep it       the deadline passes: give it up, and say why
///
/// Only what the software can do is asked of it: a farm or a network that is away, or a camera that is not plugged in,
/// is no reason to go back to an older version.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "kiosk/operator/observation.h"

namespace cyclorama {

struct HealthRules {
  std::vector<std::string> well;  ///< Processes that must say of themselves that they are well, besides answering.
  int heads = 1;                  ///< So many heads at least, of all displays together.
  int looks = 3;                  ///< So many looks in a row must find nothing.
  /// Heads that were dark when the computer was started again: their projectors may still be off. What they would show
  /// is looked at all the same.
  std::set<std::string> may_be_dark;
};

/// What is looked at: the processes, and the heads' pictures that could be had, by process and name.
struct HealthLook {
  std::vector<Observation> processes;
  std::map<std::pair<std::string, std::string>, bool> is_blank;  ///< A picture that did not come is not in it.
};

/// One sentence for each thing that is not yet as it must be; none when all is. Pure.
///   1. Every process answers.   2. Those in `well` are.   3. No display has lost its output; each of its heads has a
///   picture, and is lit, unless the display sleeps because the museum is closed: then it draws for heads that are
///   dark.
[[nodiscard]] std::vector<std::string> still_missing(const HealthLook& look, const HealthRules& rules);

/// Counts looks in a row. A process that was started again since the look before begins the count anew: one that dies
/// every few seconds answers most of the time. A value.
class HealthCount {
 public:
  explicit HealthCount(HealthRules rules) : rules_(std::move(rules)) {}
  void take(const HealthLook& look);
  [[nodiscard]] bool is_well() const { return in_a_row_ >= rules_.looks; }
  /// Of the newest look.
  [[nodiscard]] const std::vector<std::string>& missing() const { return missing_; }

 private:
  HealthRules rules_;
  int in_a_row_ = 0;
  std::map<std::string, double> uptimes_s_;
  std::vector<std::string> missing_{"nothing has been looked at yet"};
};

/// Asks every process, then every display for its heads' pictures. Blocks as ProcessLink's calls.
[[nodiscard]] HealthLook look_at(const std::vector<ProcessLink>& links);

/// The heads of all displays that are dark now, asleep or without a projector.
[[nodiscard]] std::set<std::string> dark_heads(const HealthLook& look);

/// {"well", "seconds", "version", "missing": [sentence]}, for the operator page.
[[nodiscard]] std::string health_json(const HealthCount& count, double seconds);

}  // namespace cyclorama
