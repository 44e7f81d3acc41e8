// SPDX-License-Identifier: Apache-2.0
/// The common behaviour of all programs: --help, --version, exit codes, and one clear error.
///
///   int main(int argc, char** argv) {
///     Program program("cyclorama-tour", "Leads the visit: requests pictures, feeds the displays.");
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

/// Exit codes, listed in every man page.
inline constexpr int kExitOk = 0;
inline constexpr int kExitFailed = 1;  ///< The task failed; the last line gives the reason.
inline constexpr int kExitUsage = 2;   ///< The command line is wrong.

/// A program with its command line. Thread-bound to the main thread.
class Program {
 public:
  Program(const std::string& name, const std::string& about);
  /// Options and sub-commands, to be added before run(). Names and help text become the man page.
  [[nodiscard]] CLI::App& options() { return app_; }
  /// Parses the command line, blocks the stop signals, runs the body and logs its error. Returns main's exit code.
  /// Never throws.
  int run(int argc, char** argv, const std::function<Status(const StopSignal&)>& body);

 private:
  CLI::App app_;
  std::string name_;
};

/// Makes `old_name` an option that only refers to `new_name`, which replaced it. It does not appear in --help.
void add_renamed_option(CLI::App& app, const std::string& old_name, const std::string& new_name);

}  // namespace cyclorama
