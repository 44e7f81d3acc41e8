// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/balance/replay_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/bench/balance/replay_options.h"

namespace cyclorama {
namespace {

constexpr std::string_view kOracle = "oracle";

struct ReplayCommandOptions {
  std::vector<std::string> files;
  NetworkOptions network{.nodes = {4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096}};
  std::vector<std::string> strategies;
  std::string json;
};

std::vector<std::string> all_strategies() {
  std::vector<std::string> names;
  for (const balance::BalanceStrategy strategy : balance::kBalanceStrategies)
    names.emplace_back(balance::name_of(strategy));
  names.emplace_back(kOracle);
  return names;
}

std::vector<ReplayedFrame> replay_with(const std::string& name, std::span<const balance::RecordedFrame> frames,
                                       ReplayOptions options) {
  options.oracle = name == kOracle;
  const balance::BalanceStrategy strategy =
      options.oracle ? balance::BalanceStrategy::kCostMap : *balance::balance_strategy_of(name);
  options.farm.stealing = strategy == balance::BalanceStrategy::kCostMapStealing;
  return replay(frames, options, [&] { return balance::make_balancer(strategy); });
}

nlohmann::json json_of(const std::string& file, std::size_t nodes, const std::string& strategy,
                       const ReplaySummary& sum) {
  return {{"file", file},
          {"nodes", nodes},
          {"strategy", strategy},
          {"mean", sum.mean},
          {"p5", sum.p5},
          {"least", sum.min},
          {"frames_per_s", sum.frames_per_second},
          {"gain", sum.gain},
          {"below_equal", sum.below_equal},
          {"nodes_used", sum.nodes},
          {"blocks", sum.blocks},
          {"steals", sum.steals},
          {"relative_bytes", sum.relative_bytes},
          {"plan_ms", sum.plan_ms}};
}

Status run(const ReplayCommandOptions& options, const StopSignal& stop) {
  nlohmann::json rows = nlohmann::json::array();
  for (const std::string& file : options.files) {
    TRY_ASSIGN(const std::vector<balance::RecordedFrame> frames, balance::read_cost_record(file));
    if (frames.size() < 2) {
      return Error(ErrorCode::kBadData, fmt::format("'{}' has {} frames; a replay needs two", file, frames.size()));
    }
    const balance::PictureSize size = frames.front().work.size();
    fmt::print("{}: {} frames of {}x{}\n{:>6} {:<18} {:>6} {:>6} {:>6} {:>8} {:>8} {:>7} {:>7} {:>7} {:>7} {:>8}\n",
               file, frames.size(), size.width, size.height, "nodes", "strategy", "mean", "p5", "least", "frames/s",
               "gain", "below", "used", "steals", "bytes", "plan ms");
    for (const std::size_t nodes : options.network.nodes) {
      const ReplayOptions farm = replay_options(options.network, nodes);
      const std::vector<ReplayedFrame> equal = replay_with("equal", frames, farm);
      for (const std::string& strategy : options.strategies) {
        if (stop.requested()) return tools::stopped();
        const ReplaySummary sum = summary_of(replay_with(strategy, frames, farm), equal, options.network);
        fmt::print(
            "{:>6} {:<18} {:>6.3f} {:>6.3f} {:>6.3f} {:>8.1f} {:>+7.0f}% {:>7} {:>7.0f} {:>7.1f} {:>7.2f} {:>8.3f}\n",
            nodes, strategy, sum.mean, sum.p5, sum.min, sum.frames_per_second, 100.0 * sum.gain, sum.below_equal,
            sum.nodes, sum.steals, sum.relative_bytes, sum.plan_ms);
        rows.push_back(json_of(file, nodes, strategy, sum));
      }
    }
  }
  return options.json.empty() ? Status(Done{}) : tools::write_json(options.json, rows);
}

}  // namespace

tools::RenderCommand add_replay_command(CLI::App* program) {
  CLI::App* const parser =
      program->add_subcommand("replay", "Share out recorded frames among simulated nodes by every strategy");
  const auto options = std::make_shared<ReplayCommandOptions>();
  options->strategies = all_strategies();
  parser->add_option("file", options->files, "Records, of this program or of a farm")->required();
  add_network_options(parser, &options->network);
  parser->add_option("--strategy", options->strategies, "Some of them; the oracle's cost map is of the frame itself")
      ->delimiter(',')
      ->check(CLI::IsMember(all_strategies()))
      ->capture_default_str();
  parser->add_option("--json", options->json, "Also write the figures, as JSON");
  return {parser, [options](const StopSignal& stop) { return run(*options, stop); }};
}

}  // namespace cyclorama
