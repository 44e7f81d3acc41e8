// SPDX-License-Identifier: Apache-2.0
/// cyclorama-bench-farm: a farm that many museums share, in simulated time.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/bench/shared_farm/fairness.h"
#include "tests/bench/shared_farm/scale.h"

namespace {

nlohmann::json fairness(double seconds, bool all, const std::string& only) {
  double share_min = 1.0;
  double p99_ratio = 0.0;
  fmt::print("{:34} {:>9} {:>9} {:>9} {:>9} {:>12}\n", "greedy museum", "share", "p99 ms", "p99 ratio", "busy",
             "ms per frame");
  for (const cyclorama::FairnessCase& each : cyclorama::measure_fairness(seconds, only)) {
    double p99_ms = 0.0;
    for (const cyclorama::HonestMuseum& museum : each.honest) p99_ms = std::max(p99_ms, museum.p99_ms);
    fmt::print("{:34} {:9.3f} {:9.1f} {:9.2f} {:9.2f} {:12.2f}\n", each.greed, each.share_min(), p99_ms,
               each.p99_ratio(), each.utilisation, each.coordinator_ms_per_frame);
    for (const cyclorama::HonestMuseum& museum : each.honest) {
      if (all)
        fmt::print("  {:32} {:9.3f} {:9.1f} {:9.2f}\n", museum.name, museum.share, museum.p99_ms, museum.p99_ratio);
    }
    if (!each.is_greedy()) continue;
    share_min = std::min(share_min, each.share_min());
    p99_ratio = std::max(p99_ratio, each.p99_ratio());
  }
  return {{"honest_share_min", share_min}, {"p99_ratio", p99_ratio}};
}

nlohmann::json scale(double seconds) {
  const cyclorama::ScaleFigures figures = cyclorama::measure_scale(seconds);
  fmt::print(
      "{} nodes ({} used with those that came), {} museums, {} frames in {:.0f} s: utilisation {:.3f}, coordinator "
      "{:.3f} ms "
      "per frame, p99 {:.0f} ms, {} given up, {} starved\n",
      figures.nodes, figures.nodes_used, figures.museums, figures.frames, seconds, figures.utilisation,
      figures.head_ms_per_frame, figures.p99_ms, figures.given_up, figures.starved);
  return {{"nodes", figures.nodes},
          {"museums", figures.museums},
          {"utilisation", figures.utilisation},
          {"head_ms_per_frame", figures.head_ms_per_frame},
          {"p99_ms", figures.p99_ms},
          {"starved", figures.starved}};
}

}  // namespace

// NOLINTNEXTLINE(bugprone-exception-escape): it may end the benchmark.
int main(int argc, char** argv) {
  CLI::App program("Simulates a farm that many museums share: the real scheduling, simulated rays and time.");
  std::string json;
  double seconds = 30.0;
  program.add_option("--json", json, "Also write the figures, as JSON");
  program.add_option("--seconds", seconds, "Simulated time of each case")
      ->check(CLI::Range(1.0, 1e5))
      ->capture_default_str();
  bool all = false;
  program.add_flag("--all", all, "Print each museum of each case");
  std::string only;
  program.add_option("--only", only, "Simulate only the greedy museums whose name contains this");
  program.require_subcommand(1);
  const auto* const fair = program.add_subcommand("fairness", "Nine honest museums beside a greedy one");
  const auto* const large = program.add_subcommand("scale", "64 nodes and 50 museums");
  CLI11_PARSE(program, argc, argv);
  nlohmann::json figures;
  if (fair->parsed()) figures = fairness(seconds, all, only);
  if (large->parsed()) figures = scale(seconds);
  if (json.empty()) return 0;
  std::ofstream out(json);
  out << figures.dump();
  return out.flush() ? 0 : 1;
}
