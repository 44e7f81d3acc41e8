// SPDX-License-Identifier: Apache-2.0
#include "common/process/program.h"

#include <fmt/format.h>

#include <exception>
#include <iostream>

#include "common/process/log.h"

namespace cyclorama {

Program::Program(const std::string& name, const std::string& about) : app_(about, name), name_(name) {
  app_.set_version_flag("--version", fmt::format("{} {}", name, CYCLORAMA_VERSION), "Print the version and exit");
  app_.add_flag_callback(
      "--verbose", [] { set_log_level(LogLevel::kDebug); }, "Log more");
  app_.footer("Exit status: 0 done, 1 failed (the last line says why), 2 wrong command line.");
  app_.get_formatter()->column_width(34);
}

int Program::run(int argc, char** argv, const std::function<Status(const StopSignal&)>& body) {
  try {
    app_.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app_.exit(error, std::cout, std::cerr) == 0 ? kExitOk : kExitUsage;
  }
  try {
    const StopSignal stop;
    const Status status = body(stop);
    if (status) return kExitOk;
    log(LogLevel::kError, fmt::format("{}: {}", name_, status.error().message()));
  } catch (const std::exception& error) {
    log(LogLevel::kError, fmt::format("{}: unexpected: {}", name_, error.what()));
  }
  return kExitFailed;
}

void add_renamed_option(CLI::App& app, const std::string& old_name, const std::string& new_name) {
  const auto refuse = [new_name](const std::string&) { return "is now called " + new_name; };
  app.add_option_function<std::string>(old_name, [](const std::string&) {})->check(refuse)->group("");
}

}  // namespace cyclorama
