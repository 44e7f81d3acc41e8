// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>

#include "common/process/log.h"
#include "common/process/notify.h"
#include "common/process/program.h"
#include "renderfarm/coordinator/coordinator.h"
#include "renderfarm/coordinator/coordinator_config.h"
#include "renderfarm/watch/top_command.h"

namespace cyclorama::coordinator {
namespace {

struct Arguments {
  std::string config{};
  std::vector<std::string> scenes{};
  std::vector<std::string> own_scenes{};
  std::string museums{};
  std::string nodes{};
  std::string inspect{};
  std::string balance{};
  bool insecure = false;
  bool is_check = false;
  std::string record{};
};

struct TopArguments {
  std::string config{};
  watch::TopOptions top{};
};

/// Runs `top`. The inspection address comes from the command line, else from the settings file, else from the package's
/// settings file.
Status run_top_command(TopArguments arguments, const StopSignal& stop) {
  if (arguments.top.inspect.empty() && !arguments.config.empty()) {
    TRY_ASSIGN(const CoordinatorOptions coordinator, read_coordinator_config(arguments.config));
    arguments.top.inspect = coordinator.inspect;
    if (coordinator.inspect.empty()) {
      return Error(ErrorCode::kInvalidArgument,
                   arguments.config + " has no key 'inspect', so this coordinator cannot be inspected");
    }
  }
  return watch::run_top(arguments.top, stop);
}

void add_top(CLI::App& app, TopArguments* arguments) {
  CLI::App* const top = app.add_subcommand("top", "Show the running farm: sessions, nodes and the steps of a frame");
  top->add_option("--config", arguments->config, "Connect to the coordinator that runs with this farm.toml")
      ->check(CLI::ExistingFile);
  top->add_option("--inspect", arguments->top.inspect,
                  fmt::format("The coordinator's inspection address (default {})", watch::kPackagedInspect));
  top->add_flag("--once", arguments->top.once, "Show it once and exit; always so if the output is not a terminal");
  top->add_flag("--json", arguments->top.json, "Show it once, as JSON");
}

/// Returns the settings. The command line overrides the settings file.
Result<CoordinatorOptions> options_from(const Arguments& arguments) {
  CoordinatorOptions options;
  if (!arguments.config.empty()) {
    TRY_ASSIGN(options, read_coordinator_config(arguments.config));
  }
  if (!arguments.scenes.empty() || !arguments.own_scenes.empty()) options.scenes.clear();
  for (const auto* const texts : {&arguments.scenes, &arguments.own_scenes}) {
    for (const std::string& text : *texts) {
      TRY_ASSIGN(FarmScene scene, parse_farm_scene(text));
      scene.on_coordinator = texts == &arguments.own_scenes;
      options.scenes.push_back(std::move(scene));
    }
  }
  if (!arguments.museums.empty()) options.museums = arguments.museums;
  if (!arguments.nodes.empty()) options.nodes = arguments.nodes;
  if (!arguments.inspect.empty()) options.inspect = arguments.inspect;
  if (!arguments.balance.empty()) options.strategy = *balance::balance_strategy_of(arguments.balance);
  options.trust.insecure = options.trust.insecure || arguments.insecure;
  options.record = arguments.record;
  return options;
}

void log_notice(const std::string& sentence, const NoticeAbout& about) {
  const bool has_session = about.session != SessionId{};
  const std::array<LogField, 3> fields{
      {{"CYCLORAMA_NODE", about.node},
       {"CYCLORAMA_MUSEUM", about.museum},
       {"CYCLORAMA_SESSION", has_session ? fmt::format("{}", static_cast<std::uint64_t>(about.session)) : ""}}};
  log(about.is_trouble ? LogLevel::kWarning : LogLevel::kInfo, sentence, fields);
}

Status run(const Arguments& arguments, const StopSignal& stop) {
  TRY_ASSIGN(CoordinatorOptions options, options_from(arguments));
  if (arguments.is_check) return validate(options);
  TRY_ASSIGN(const auto coordinator, Coordinator::start(std::move(options), log_notice));
  log(LogLevel::kNotice, fmt::format("listening on port {} for museums, on port {} for nodes",
                                     coordinator->museum_port(), coordinator->node_port()));
  Notify notify;
  notify.ready();
  std::string last_state;
  constexpr auto kPeriod = std::chrono::milliseconds(500);
  constexpr auto kHung = std::chrono::seconds(5);
  const SteadyClock clock;
  while (!stop.wait_until(clock.now() + kPeriod)) {
    if (clock.now() - coordinator->alive_at() < kHung) notify.keep_alive(clock.now());
    if (std::string state = coordinator->state(); state != last_state) {
      notify.status(state);
      last_state = std::move(state);
    }
  }
  notify.stopping();
  coordinator->stop();
  if (coordinator->sent_file_bytes() > 0) {
    log(LogLevel::kInfo, fmt::format("gave nodes {} bytes of scenes' files", coordinator->sent_file_bytes()));
  }
  return Done{};
}

}  // namespace
}  // namespace cyclorama::coordinator

int main(int argc, char** argv) {
  using namespace cyclorama;
  using namespace cyclorama::coordinator;
  Program program(
      "cyclorama-farm",
      "The render farm's coordinator: museums and nodes connect to it, and it splits each picture among the nodes.");
  Arguments arguments;
  CLI::App& app = program.options();
  app.add_option("--config", arguments.config, "Read this farm.toml; the other options override it")
      ->check(CLI::ExistingFile);
  app.add_option("--scene", arguments.scenes, "NAME=PATH of a scene on the nodes' disks; the first is the default");
  app.add_option("--scene-on-coordinator", arguments.own_scenes,
                 "NAME=PATH of a scene on this disk, which nodes fetch");
  app.add_option("--museums", arguments.museums, "Listening address for museums (default [::1]:7401)");
  app.add_option("--nodes", arguments.nodes, "Listening address for nodes (default [::1]:7402)");
  app.add_option("--inspect", arguments.inspect,
                 "Listening address for `cyclorama-farm top` and the operator (default: none)");
  app.add_option("--balance", arguments.balance, "How pictures are split; all but the first are for comparison")
      ->check(CLI::IsMember({"cost-map-stealing", "cost-map", "pbt-leaves", "pbt", "equal"}));
  app.add_option("--record", arguments.record,
                 "Record the costs of frames in this folder, for cyclorama-bench-balance");
  app.add_flag("--insecure", arguments.insecure, "Accept connections from other machines without TLS");
  app.add_flag("--check", arguments.is_check, "Check the settings and exit: 0 if they are valid");
  TopArguments top;
  add_top(app, &top);
  return program.run(argc, argv, [&](const StopSignal& stop) {
    return app.got_subcommand("top") ? run_top_command(top, stop) : run(arguments, stop);
  });
}
