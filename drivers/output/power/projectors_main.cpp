// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <thread>

#include "common/base/clock.h"
#include "common/base/file.h"
#include "common/process/log.h"
#include "common/process/program.h"
#include "drivers/output/power/pjlink.h"

namespace cyclorama {
namespace {

constexpr auto kAnswerWithin = std::chrono::seconds(5);
constexpr auto kAgainAfter = std::chrono::seconds(5);
constexpr int kPort = 4352;

struct Options {
  std::string command;
  std::vector<std::string> projectors;
  std::string password_file;
  double within_s = 240.0;
};

Result<PjlinkProjector> projector_of(const std::string& text, const std::string& password) {
  auto address = parse_address(text);
  if (!address) address = parse_address(fmt::format("{}:{}", text, kPort));
  if (!address) return std::move(address).error();
  return PjlinkProjector{*std::move(address), password};
}

/// Until it is as wished, or on its way there: one that cools down takes no command for a minute or two.
Status bring(const PjlinkProjector& projector, bool is_on, TimePoint deadline, const StopSignal& stop) {
  for (;;) {
    auto set = set_power(projector, is_on, kAnswerWithin);
    if (set || set.error().code() != ErrorCode::kUnavailable) return set;
    if (stop.requested() || SteadyClock().now() + kAgainAfter > deadline) return set;
    std::this_thread::sleep_for(kAgainAfter);
  }
}

Status run(const Options& options, const StopSignal& stop) {
  std::string password;
  if (!options.password_file.empty()) {
    TRY_ASSIGN(password, read_text_file(options.password_file, 256));
    while (!password.empty() && (password.back() == '\n' || password.back() == '\r')) password.pop_back();
  }
  const TimePoint deadline =
      SteadyClock().now() + std::chrono::duration_cast<Duration>(std::chrono::duration<double>(options.within_s));
  std::size_t failed = 0;
  for (const std::string& text : options.projectors) {
    TRY_ASSIGN(const PjlinkProjector projector, projector_of(text, password));
    auto done = options.command == "ask" ? Status(Done{}) : bring(projector, options.command == "on", deadline, stop);
    const auto power = done ? ask_power(projector, kAnswerWithin) : Result<ProjectorPower>(std::move(done).error());
    if (power) {
      fmt::print("{}: {}\n", text, text_of(*power));
    } else {
      ++failed;
      log(LogLevel::kWarning, power.error().message());
    }
  }
  if (failed == 0) return Done{};
  return Error(ErrorCode::kUnavailable, fmt::format("{} of {} projectors failed", failed, options.projectors.size()));
}

}  // namespace
}  // namespace cyclorama

int main(int argc, char** argv) {
  using namespace cyclorama;
  Program program("cyclorama-projectors",
                  "Switches projectors on and off over the network (PJLink class 1), or asks how they are.");
  Options options;
  program.options()
      .add_option("command", options.command, "on, off or ask")
      ->required()
      ->check(CLI::IsMember({"on", "off", "ask"}));
  program.options()
      .add_option("projectors", options.projectors, "HOST or HOST:PORT of each; port 4352 if none is given")
      ->required();
  program.options().add_option("--password-file", options.password_file, "A file that holds their password");
  program.options()
      .add_option("--within", options.within_s, "Seconds to try a projector that cannot just now")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  return program.run(argc, argv, [&](const StopSignal& stop) { return run(options, stop); });
}
