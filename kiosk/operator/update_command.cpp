// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/update_command.h"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>

#include "common/base/clock.h"
#include "common/base/file.h"
#include "kiosk/update/update_status.h"

namespace cyclorama::operations {
namespace {

namespace fs = std::filesystem;
using State = update::UpdateStatus::State;

constexpr std::size_t kMaxStatusBytes = 64 * 1024;
constexpr auto kBetweenLooks = std::chrono::milliseconds(500);

}  // namespace

void UpdateCommand::add_to(CLI::App* app) {
  CLI::App& command = *app->add_subcommand(
      "update", "Look for a newer version now, on a USB stick named CYCLORAMA or at the farm, and report the result");
  command.add_option("--requests", requests, "Folder in which the museum image looks for requests")
      ->capture_default_str();
  command.add_option("--museum", museum, "The museum's state folder")->capture_default_str();
  command.add_option("--wait", wait_s, "Seconds to wait for the result; the update continues regardless")
      ->check(CLI::Range(0.0, 86400.0))
      ->capture_default_str();
}

Status UpdateCommand::run(const StopSignal& stop) const {
  std::error_code failed;
  if (!fs::is_directory(requests, failed)) {
    return Error(ErrorCode::kNotFound,
                 fmt::format("'{}' is not there: this computer's software is not managed by the museum image, or its "
                             "operator page does not run; install the newer packages instead",
                             requests));
  }
  const fs::path wanted = fs::path(requests) / "update", report = fs::path(museum) / update::kUpdateStatusFile;
  const auto said = [&report]() -> Result<update::UpdateStatus> {
    TRY_ASSIGN(const std::string text, read_text_file(report, kMaxStatusBytes));
    return update::parse_update_status(text);
  };
  const auto before = said();
  TRY(write_file_atomically(wanted, std::string_view("\n")));
  const SteadyClock clock;
  const TimePoint deadline = clock.now() + std::chrono::duration_cast<Duration>(std::chrono::duration<double>(wait_s));
  // The updater has begun when the request file is gone, and is done when it reports any state but checking or loading.
  bool is_over = false;
  update::UpdateStatus status;
  while (!is_over && clock.now() < deadline && !stop.wait_until(clock.now() + kBetweenLooks)) {
    const auto parsed = said();
    if (!parsed || fs::exists(wanted, failed)) continue;
    status = *parsed;
    is_over =
        (!before || status.at != before->at) && status.state != State::kChecking && status.state != State::kLoading;
  }
  if (!is_over) return Error(ErrorCode::kTimedOut, "no answer yet; 'cyclorama doctor' shows it when it has come");
  const std::string sentence = fmt::format("{} runs: {}", status.version, status.sentence);
  if (status.state == State::kFailed) return Error(ErrorCode::kUnavailable, sentence);
  std::printf("%s\n", sentence.c_str());
  return Done{};
}

}  // namespace cyclorama::operations
