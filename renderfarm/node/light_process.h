// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "common/base/unique_fd.h"
#include "renderfarm/node/light_computation.h"

namespace cyclorama::node {

/// A program that computes light. It reports on its standard output, line by line:
///
///   progress SHARE | error SENTENCE | stage NUMBER KEY PIECES FOLDER | piece STAGE PIECE SHA256 BYTES
///
/// and gets orders on its standard input, a socket that keeps messages apart: "compute STAGE PIECE" or "fetched STAGE
/// PIECE". It succeeded if it exits with 0. It is paused by SIGSTOP, so it needs no cooperation and stops within
/// milliseconds.
class LightProcess final : public LightComputation {
 public:
  /// Starts `command`, the program's path followed by its arguments. Errors: kNotFound or kSystem.
  static Result<std::unique_ptr<LightComputation>> start(const std::vector<std::string>& command);
  ~LightProcess() override;

  void pause() override;
  void resume() override;
  void compute(std::uint32_t stage, std::uint32_t piece) override;
  void fetched(std::uint32_t stage, std::uint32_t piece) override;
  [[nodiscard]] std::vector<LightEvent> events() override;
  [[nodiscard]] double done_share() override;
  [[nodiscard]] std::optional<Status> result() override;

 private:
  LightProcess(pid_t process, UniqueFd orders, UniqueFd output)
      : process_(process), orders_(std::move(orders)), output_(std::move(output)) {}
  void read_output();
  void read_line(const std::string& line);
  void send_signal(int number) const;
  void send_order(const char* verb, std::uint32_t stage, std::uint32_t piece) const;

  std::atomic<pid_t> process_;  ///< 0 once it has ended.
  const UniqueFd orders_;
  UniqueFd output_;
  std::vector<LightEvent> events_;
  std::string unread_;  ///< Begin of a line.
  std::string error_;
  double done_share_ = 0.0;
};

}  // namespace cyclorama::node
