// SPDX-License-Identifier: Apache-2.0
/// cyclorama-bench-governor: governed sessions on simulated farms.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/bench/governor/governor_simulation.h"

namespace {

void print(const cyclorama::GovernorOutcome& outcome) {
  for (const cyclorama::GovernorSegment& segment : outcome.segments) {
    fmt::print("{:5} {:5.0f} {:5.0f} {:>5} {:4} {:8.2f} {:6.3f} {:6.3f} {:7} {:6.2f}{}\n", outcome.simulated.cores,
               outcome.simulated.budget_ms, 100 * outcome.simulated.fixed_part,
               outcome.simulated.has_rays ? "yes" : "no", outcome.simulated.seed, segment.settled_s, segment.used,
               segment.p95, segment.changes, segment.min_scale, segment.is_feasible ? "" : "  out of range");
  }
}

}  // namespace

// NOLINTNEXTLINE(bugprone-exception-escape): it may end the benchmark.
int main(int argc, char** argv) {
  using namespace cyclorama;  // NOLINT(google-build-using-namespace)
  CLI::App program("Simulates governed sessions: how soon they settle, and how much of the budget they use.");
  std::string json;
  int seeds = 10;
  bool all = false;
  program.add_option("--json", json, "Also write the figures, as JSON");
  program.add_option("--seeds", seeds, "Runs of each case")->check(CLI::Range(1, 1000))->capture_default_str();
  program.add_flag("--all", all, "Print each region of each case");
  CLI11_PARSE(program, argc, argv);
  std::vector<GovernorOutcome> outcomes;
  if (all) fmt::print("cores    ms fixed  rays seed  settled   used    p95 changes  scale\n");
  for (const GovernorCase& simulated : governor_cases(seeds)) {
    outcomes.push_back(simulate(governor::ParetoFront::standard(), simulated));
    if (all) print(outcomes.back());
  }
  const GovernorFigures figures = figures_of(outcomes);
  fmt::print(
      "{} cases: settled after {:.2f} s at most, {:.1f} % of the budget used at least, {} over it at p95, {} "
      "stuck, {:.2f} changes of quality per second at most\n",
      figures.cases, figures.settled_s_max, 100 * figures.used_min, figures.over_p95, figures.stuck,
      figures.changes_per_s_max);
  if (json.empty()) return 0;
  std::ofstream out(json);
  out << nlohmann::json{{"cases", figures.cases},
                        {"settled_s_max", figures.settled_s_max},
                        {"used_min", figures.used_min},
                        {"over_p95", figures.over_p95},
                        {"stuck", figures.stuck}}
             .dump();
  return out.flush() ? 0 : 1;
}
