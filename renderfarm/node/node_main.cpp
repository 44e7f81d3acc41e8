// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <utility>

#include "common/base/give_way.h"
#include "common/process/log.h"
#include "common/process/notify.h"
#include "common/process/program.h"
#include "renderfarm/node/embree_block_renderer.h"
#include "renderfarm/node/farm_node.h"
#include "renderfarm/node/light_program.h"
#include "renderfarm/node/node_config.h"

namespace cyclorama::node {
namespace {

struct Arguments {
  std::string config{};
  FarmNodeOptions options{.threads = 0};
  double memory_gib = 0.0;
  bool is_check = false;
  std::string light_of{};  ///< A scene. If set, the program only computes its light, into `light_file`.
  std::string light_file{};
};

/// Returns the settings. The options are named like the keys of node.toml and override them.
Result<FarmNodeOptions> options_from(const Arguments& arguments) {
  FarmNodeOptions said = arguments.options;
  said.memory_limit_bytes = bytes_of_gib(arguments.memory_gib);
  if (!arguments.config.empty()) {
    TRY_ASSIGN(const FarmNodeOptions file, read_node_config(arguments.config));
    if (said.coordinators.empty()) said.coordinators = file.coordinators;
    if (said.name.empty()) said.name = file.name;
    if (said.threads == 0) said.threads = file.threads;
    if (said.memory_limit_bytes == 0) said.memory_limit_bytes = file.memory_limit_bytes;
    if (said.cache.folder.empty()) said.cache.folder = file.cache.folder;
    said.cache.limit_bytes = file.cache.limit_bytes;
    said.computes_light = file.computes_light;
    said.tls = file.tls;
  }
  return complete(std::move(said));
}

Status run(const Arguments& arguments, const StopSignal& stop) {
  if (!arguments.light_of.empty()) {
    return run_light_program(arguments.light_of, arguments.light_file, arguments.options.threads);
  }
  TRY_ASSIGN(FarmNodeOptions options, options_from(arguments));
  if (arguments.is_check) return Done{};
  // Without a cache, as in tests and benchmarks, no light is written into the scene's folder, because others may
  // measure that scene.
  const bool has_light = options.computes_light && !options.cache.folder.empty();
  const LightStarter light = has_light ? light_process_starter(options.threads) : nullptr;
  options.crew = std::make_shared<render::Crew>(options.threads, [] { give_way(kRaysGiveWay); });
  TRY_ASSIGN(const auto node, FarmNode::start(options, embree_scene_loader(options.crew), light));
  Notify notify;
  notify.ready();
  std::string last_state;
  constexpr auto kPeriod = std::chrono::milliseconds(500);
  constexpr auto kHung = std::chrono::seconds(60);  // A cell of 16 x 16 pixels at 4096 samples takes seconds.
  const SteadyClock clock;
  while (!stop.wait_until(clock.now() + kPeriod)) {
    if (node->has_moved_since(clock.now() - kHung)) notify.keep_alive(clock.now());
    if (std::string state = node->state(); state != last_state) {
      notify.status(state);
      log(LogLevel::kInfo, state);
      last_state = std::move(state);
    }
  }
  notify.stopping();
  log(LogLevel::kInfo, "draining: the node renders the blocks that it has, then stops");
  node->drain(std::chrono::seconds(5));
  if (node->is_loading()) {
    // Loading cannot be aborted and may take minutes; a node holds no state that justifies the wait.
    log(LogLevel::kNotice, "stopping in the middle of loading a scene");
    std::_Exit(kExitOk);
  }
  node->stop();
  return Done{};
}

}  // namespace
}  // namespace cyclorama::node

int main(int argc, char** argv) {
  using namespace cyclorama;
  using namespace cyclorama::node;
  Program program(
      "cyclorama-node",
      "Ray traces for a render farm: connects to coordinators, loads the scenes that they order, renders blocks.");
  Arguments arguments;
  CLI::App& app = program.options();
  app.add_option("--config", arguments.config, "Read this node.toml; the other options override it")
      ->check(CLI::ExistingFile);
  FarmNodeOptions& options = arguments.options;
  app.add_option("--coordinator", options.coordinators,
                 "Address of a coordinator, such as [::1]:7402; several are served at once");
  app.add_option("--threads", options.threads, "Threads that render (default: all)")
      ->check(CLI::Range(1, kMaxNodeThreads));
  app.add_option("--memory-gib", arguments.memory_gib,
                 "Limit for scenes and pictures at rest together (default: scenes are not limited)")
      ->check(CLI::Range(kMinMemoryGib, kMaxMemoryGib));
  app.add_option("--cache", options.cache.folder,
                 "Folder for scenes that coordinators distribute (default: none are accepted)");
  // The node starts itself with these options to compute light; they are not meant for users.
  CLI::Option* const light_of = app.add_option(kLightOfOption, arguments.light_of)->group("");
  app.add_option(kLightFileOption, arguments.light_file)->group("")->needs(light_of);
  app.add_flag("--check", arguments.is_check, "Check the settings and exit: 0 if they are valid");
  app.add_option("--name", options.name, "Name shown to the operator (default: the host's name)");
  return program.run(argc, argv, [&](const StopSignal& stop) { return run(arguments, stop); });
}
