// SPDX-License-Identifier: Apache-2.0
/// cyclorama-bench-balance: compares strategies for dividing pictures among nodes, without a farm.
#include <array>

#include "common/process/program.h"
#include "tests/bench/balance/figure9_command.h"
#include "tests/bench/balance/record_command.h"
#include "tests/bench/balance/replay_command.h"

int main(int argc, char** argv) {
  using namespace cyclorama;  // NOLINT(google-build-using-namespace)
  Program program("cyclorama-bench-balance",
                  "Records what pictures cost, and replays it on any number of simulated nodes.");
  CLI::App* const options = &program.options();
  options->require_subcommand(1);
  const std::array commands{add_record_command(options), add_replay_command(options), add_figure9_command(options)};
  return program.run(argc, argv, [&](const StopSignal& stop) -> Status {
    for (const tools::RenderCommand& command : commands) {
      if (command.parser->parsed()) return command.run(stop);
    }
    return Done{};
  });
}
