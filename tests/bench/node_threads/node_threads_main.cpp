// SPDX-License-Identifier: Apache-2.0
/// cyclorama-bench-node: how well a node uses many threads, with recorded cells and simulated threads.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "renderfarm/node/block_lanes.h"
#include "tests/bench/node_threads/block_trace.h"
#include "tests/bench/node_threads/simulated_threads.h"

namespace {

using namespace cyclorama;

struct Options {
  std::string scene;
  std::string json;
  TracedPicture picture;
  int visits = 4;
  int recorded = 4;
  double seconds = 10.0;
  std::vector<int> threads = {1, 2, 4, 8, 16, 32, 64, 128};
  std::vector<std::size_t> lanes = {1, 2, 3, 4, 6, 8};
};

void print_trace(const std::vector<BlockTrace>& blocks) {
  double cells = 0.0;
  double serial = 0.0;
  double encoding = 0.0;
  std::size_t steps = 0;
  for (const BlockTrace& block : blocks) {
    serial += block.rest_seconds;
    for (const float seconds : block.encoding) encoding += static_cast<double>(seconds);
    for (const BlockTrace::Step& step : block.rendering) {
      serial += step.serial_seconds;
      ++steps;
      for (const float seconds : step.cells) cells += static_cast<double>(seconds);
    }
  }
  const auto count = static_cast<double>(blocks.size());
  fmt::print(
      "a frame: {:.0f} ms of threads in cells, {:.1f} ms of its own thread between {:.1f} steps, {:.0f} ms of JPEG\n",
      1e3 * cells / count, 1e3 * serial / count, static_cast<double>(steps) / count, 1e3 * encoding / count);
}

int measure(const Options& options) {
  nlohmann::json rows = nlohmann::json::array();
  // Only for more than eight threads are tiles rendered together; fewer have as many steps as are recorded, or more.
  const auto blocks =
      traced_blocks(options.scene, options.picture, options.recorded, std::ranges::max(options.threads));
  if (!blocks) {
    fmt::print(stderr, "{}\n", blocks.error().message());
    return 1;
  }
  print_trace(*blocks);
  for (const int threads : options.threads) {
    for (const std::size_t lanes : options.lanes) {
      const ThreadsUse use = simulated_use(*blocks, threads, lanes, options.visits, options.seconds);
      const bool is_used = lanes == node::lanes_for(threads);
      fmt::print(
          "{:>4} threads, {} lanes{}: utilisation {:.3f}, {:7.2f} frames/s, frame p50 {:7.1f} ms, p99 {:7.1f} ms\n",
          threads, lanes, is_used ? "*" : " ", use.utilisation, use.frames_per_second, use.frame_ms_p50,
          use.frame_ms_p99);
      rows.push_back({{"threads", threads},
                      {"lanes", lanes},
                      {"used", is_used},
                      {"utilisation", use.utilisation},
                      {"frames_per_s", use.frames_per_second},
                      {"simulated", true}});
    }
  }
  fmt::print("* what a node of so many threads uses\n");
  if (options.json.empty()) return 0;
  std::ofstream(options.json) << nlohmann::json{{"benchmark", "node-threads"}, {"rows", rows}}.dump() << '\n';
  return 0;
}

}  // namespace

// NOLINTNEXTLINE(bugprone-exception-escape): it may end the benchmark.
int main(int argc, char** argv) {
  CLI::App program("Records how long a node's cells take, and simulates nodes of more threads than this machine has.");
  Options options;
  program.add_option("scene", options.scene, "The scene")->required();
  program.add_option("--json", options.json, "Also write the figures, as JSON");
  program.add_option("--width", options.picture.width_px, "Of the pictures, in pixels")->capture_default_str();
  program.add_option("--height", options.picture.height_px, "Of the pictures, in pixels")->capture_default_str();
  program.add_option("--samples", options.picture.samples, "Per pixel")->capture_default_str();
  program.add_flag("!--no-denoise", options.picture.denoise, "Pictures as they are traced");
  program.add_flag("--stored-light", options.picture.stored_light, "Read the light in the scene's folder");
  program.add_option("--visits", options.visits, "Each has two frames in flight")->capture_default_str();
  program.add_option("--recorded", options.recorded, "Frames that are recorded, from several eyes")
      ->capture_default_str();
  program.add_option("--seconds", options.seconds, "Simulated time of each case")->capture_default_str();
  program.add_option("--threads", options.threads, "Of the simulated nodes")->delimiter(',');
  program.add_option("--lanes", options.lanes, "Blocks in work at once")->delimiter(',');
  CLI11_PARSE(program, argc, argv);
  return measure(options);
}
