// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <thread>

#include "common/config/config.h"
#include "common/process/log.h"
#include "common/process/notify.h"
#include "common/process/program.h"
#include "renderfarm/node/embree_block_renderer.h"
#include "renderfarm/node/farm_node.h"

namespace cyclorama {
namespace {

constexpr int kMostThreads = 4096;

struct Arguments {
  std::string config{};
  std::string head{};
  std::string name{};
  int threads = 0;
};

std::string host_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "node";
}

/// node.toml's keys are the options' names; what the command line says overrules it.
Result<FarmNodeOptions> options_from(Arguments arguments) {
  if (!arguments.config.empty()) {
    TRY_ASSIGN(Config config, Config::read(arguments.config));
    ConfigTable root = config.root();
    const std::string head = root.text("head");
    const std::string name = root.text("name", "");
    const int threads = root.integer("threads", {0, kMostThreads}, 0);
    TRY(config.finish());
    if (arguments.head.empty()) arguments.head = head;
    if (arguments.name.empty()) arguments.name = name;
    if (arguments.threads == 0) arguments.threads = threads;
  }
  if (arguments.head.empty()) {
    return Error(ErrorCode::kInvalidArgument, "no head is given; write --head [::1]:7402, or 'head' in node.toml");
  }
  const int all_threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  return FarmNodeOptions{arguments.head, arguments.name.empty() ? host_name() : arguments.name,
                         arguments.threads > 0 ? arguments.threads : all_threads};
}

Status run(const Arguments& arguments, const StopSignal& stop) {
  TRY_ASSIGN(const FarmNodeOptions options, options_from(arguments));
  TRY_ASSIGN(const auto node, FarmNode::start(options, embree_scene_loader(options.threads)));
  Notify notify;
  notify.ready();
  std::string told;
  constexpr auto kPeriod = std::chrono::milliseconds(500);
  constexpr auto kHung = std::chrono::seconds(60);  // A cell of 16 x 16 pixels at 4096 samples takes seconds.
  const SteadyClock clock;
  while (!stop.wait_until(clock.now() + kPeriod)) {
    if (node->has_moved_since(clock.now() - kHung)) notify.keep_alive(clock.now());
    if (std::string state = node->state(); state != told) {
      notify.status(state);
      log(LogLevel::kInfo, state);
      told = std::move(state);
    }
  }
  notify.stopping();
  if (node->is_loading()) {
    // A load cannot be broken off and may take minutes; a node holds nothing that is worth the wait.
    log(LogLevel::kNotice, "stopping in the middle of loading a scene");
    std::_Exit(kExitOk);
  }
  node->stop();
  return Done{};
}

}  // namespace
}  // namespace cyclorama

int main(int argc, char** argv) {
  using namespace cyclorama;
  Program program("cyclorama-node",
                  "Ray traces for a render farm: dials its head, loads the scenes it is told to, renders blocks.");
  Arguments arguments;
  CLI::App& app = program.options();
  app.add_option("--config", arguments.config, "Read this node.toml; the other options overrule it")
      ->check(CLI::ExistingFile);
  app.add_option("--head", arguments.head, "The farm's head, such as [::1]:7402");
  app.add_option("--threads", arguments.threads, "Threads that render (default: all)")
      ->check(CLI::Range(1, kMostThreads));
  app.add_option("--name", arguments.name, "How people call this node (default: the host's name)");
  return program.run(argc, argv, [&](const StopSignal& stop) { return run(arguments, stop); });
}
