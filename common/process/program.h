// SPDX-License-Identifier: Apache-2.0
/// What every program of the house does alike: --help, --version, exit codes, one clear error.
///
///   int main(int argc, char** argv) {
///     Program program("cyclorama-tour", "Leads the visit: steers, asks the farm, feeds the displays.");
///     std::string config; program.options().add_option("--site", config, "site.toml")->required();
///     return program.run(argc, argv, [&](const StopSignal& stop) { return run_tour(config, stop); });
///   }
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "common/base/result.h"
#include "common/process/stop_signal.h"

namespace cyclorama {

/// Exit codes, in every man page.
inline constexpr int kExitOk = 0;
inline constexpr int kExitFailed = 1;  ///< It could not do what it was asked; the last line says why.
inline constexpr int kExitUsage = 2;   ///< The command line is wrong.

/// Thread-bound: main's.
class Program {
 public:
  Program(const std::string& name, const std::string& about);
  /// Options and sub-commands are added here before run(). Names and help text become the man page.
  [[nodiscard]] CLI::App& options() { return app_; }
  /// Parses, blocks the stop signals, runs the body, logs its error. Returns what main returns. Nothing is thrown past it.
  int run(int argc, char** argv, const std::function<Status(const StopSignal&)>& body);

 private:
  CLI::App app_;
  std::string name_;
};

/// Makes `old_name` an option that only names `new_name`, which replaced it. It does not show in --help.
void add_renamed_option(CLI::App& app, const std::string& old_name, const std::string& new_name);

}  // namespace cyclorama
