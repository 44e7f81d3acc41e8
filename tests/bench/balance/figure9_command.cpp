// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/balance/figure9_command.h"

#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>

#include "common/base/file.h"
#include "tests/bench/balance/replay_options.h"
#include "tests/bench/render/trade/plot.h"

namespace cyclorama {
namespace {

struct Figure9Options {
  std::vector<std::string> scenes;
  NetworkOptions network{.nodes = {1, 2, 4, 8, 16, 32, 64, 128, 256, 512}};
  std::string svg;
  std::string json;
};

struct NamedRecord {
  std::string name;
  std::vector<balance::RecordedFrame> frames;
};

Result<NamedRecord> named_record(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == 0 || equals == std::string::npos) {
    return Error(ErrorCode::kInvalidArgument, fmt::format("'{}' is not NAME=FILE", text));
  }
  NamedRecord record{text.substr(0, equals), {}};
  TRY_ASSIGN(record.frames, balance::read_cost_record(text.substr(equals + 1)));
  if (record.frames.size() < 2) {
    return Error(ErrorCode::kBadData, fmt::format("'{}' has fewer than two frames", text.substr(equals + 1)));
  }
  return record;
}

double frames_per_second(const NamedRecord& record, balance::BalanceStrategy strategy, std::size_t nodes,
                         const NetworkOptions& network) {
  ReplayOptions options = replay_options(network, nodes);
  options.farm.stealing = strategy == balance::BalanceStrategy::kCostMapStealing;
  const auto frames = replay(record.frames, options, [&] { return balance::make_balancer(strategy); });
  return summary_of(frames, frames, network).frames_per_second;
}

Status run(const Figure9Options& options, const StopSignal& stop) {
  // The scheme of the paper, and the one of this project.
  constexpr std::array kStrategies{balance::BalanceStrategy::kPbt, balance::BalanceStrategy::kCostMapStealing};
  constexpr std::array kColours{"#1b9e77", "#d95f02", "#7570b3", "#e7298a", "#66a61e", "#e6ab02"};
  std::vector<NamedRecord> records;
  for (const std::string& scene : options.scenes) {
    TRY_ASSIGN(NamedRecord record, named_record(scene));
    records.push_back(std::move(record));
  }
  std::vector<Plot> panels;
  nlohmann::json rows = nlohmann::json::array();
  for (const balance::BalanceStrategy strategy : kStrategies) {
    Plot plot{"nodes", fmt::format("frames per second, {}", balance::name_of(strategy)), {}};
    fmt::print("{}, frames/s\n{:>8}", balance::name_of(strategy), "nodes");
    for (const NamedRecord& record : records) {
      fmt::print(" {:>12}", record.name);
      plot.series.push_back({record.name, kColours[plot.series.size() % kColours.size()], {}, true});
    }
    fmt::print("\n");
    for (const std::size_t nodes : options.network.nodes) {
      fmt::print("{:>8}", nodes);
      for (std::size_t i = 0; i < records.size(); ++i) {
        if (stop.requested()) return tools::stopped();
        const double rate = frames_per_second(records[i], strategy, nodes, options.network);
        fmt::print(" {:>12.1f}", rate);
        plot.series[i].points.push_back({static_cast<double>(nodes), rate});
        rows.push_back({{"strategy", balance::name_of(strategy)},
                        {"scene", records[i].name},
                        {"nodes", nodes},
                        {"frames_per_s", rate}});
      }
      fmt::print("\n");
    }
    panels.push_back(std::move(plot));
  }
  if (!options.svg.empty()) {
    TRY(write_file_atomically(options.svg, std::string_view(plot_svg("Frame rate against nodes, by scene", panels))));
  }
  return options.json.empty() ? Status(Done{}) : tools::write_json(options.json, rows);
}

}  // namespace

tools::RenderCommand add_figure9_command(CLI::App* program) {
  CLI::App* const parser = program->add_subcommand(
      "figure9", "Frame rate against nodes for scenes of several sizes, by the paper's tree and by ours");
  const auto options = std::make_shared<Figure9Options>();
  parser->add_option("scene", options->scenes, "NAME=FILE: a record, and what it is called")->required();
  add_network_options(parser, &options->network);
  parser->add_option("--svg", options->svg, "Also draw it");
  parser->add_option("--json", options->json, "Also write the figures, as JSON");
  return {parser, [options](const StopSignal& stop) { return run(*options, stop); }};
}

}  // namespace cyclorama
