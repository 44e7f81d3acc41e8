// SPDX-License-Identifier: Apache-2.0
/// A governed session on a simulated farm, in simulated time: how soon the governor settles, and how much of the budget
/// it uses without exceeding it.
///
///     cheap region        expensive region (x 3)     cheap region again
///     0 s ──────────────▶ 20 s ────────────────────▶ 40 s ─────────────▶ 60 s
///     cold start          the picture must give way   and come back
#pragma once

#include <string>
#include <vector>

#include "renderfarm/governor/governor.h"

namespace cyclorama {

struct GovernorCase {
  int cores = 64;
  double budget_ms = 50.0;
  double fixed_part = 0.1;  ///< Time of a frame that depends on no pixel, as a part of the budget.
  bool has_rays = true;     ///< Nodes report thread times.
  unsigned seed = 1;
  [[nodiscard]] std::string name() const;
};

/// One region, from its start on.
struct GovernorSegment {
  /// Time until the expected frame time enters 70 to 100 % of the budget and stays there for a second. If no picture of
  /// the front is in that range, its cheapest or best one counts instead.
  double settled_s = 0.0;
  /// Mean and 95th percentile of the frames after 2 s, as a part of the budget.
  double used = 0.0;
  double p95 = 0.0;
  int changes = 0;         ///< Changes of the quality after 2 s.
  double min_scale = 1.0;  ///< After 2 s.
  /// Pictures of the front exist for that part of the budget: neither is the cheapest too expensive nor the best cheap.
  bool is_feasible = true;
};

struct GovernorOutcome {
  GovernorCase simulated;
  std::vector<GovernorSegment> segments;
};

struct GovernorFigures {
  int cases = 0;
  double settled_s_max = 0.0;
  double used_min = 1.0;
  int over_p95 = 0;                ///< Segments whose 95th percentile exceeds the budget.
  int stuck = 0;                   ///< Segments that never settled.
  double changes_per_s_max = 0.0;  ///< Changes of the quality, once settled.
};

/// Runs the session. The farm has two frames in flight; a frame's time has normal noise of 4 % in its rays and of 10 %
/// in its fixed part, costs sway by 5 % while the visitor walks, one frame of 200 takes three times as long (never
/// two in a row, which would be a jump), and the
/// front's costs are wrong by an exponent of 0.85 to 1.1, as for a scene that was not measured.
[[nodiscard]] GovernorOutcome simulate(const governor::ParetoFront& front, const GovernorCase& simulated);
/// Returns the cases: 2 to 4096 cores, budgets of 33 to 100 ms, fixed parts of 0 to 40 %, with thread times and
/// without.
[[nodiscard]] std::vector<GovernorCase> governor_cases(int seeds);
/// Summarizes; used and p95 are those of feasible segments.
[[nodiscard]] GovernorFigures figures_of(const std::vector<GovernorOutcome>& outcomes);

}  // namespace cyclorama
