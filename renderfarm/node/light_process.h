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

/// A child process that computes light and reports on its standard output, line by line: "progress SHARE" or "error
/// SENTENCE". It succeeded if it exits with 0. SIGSTOP pauses it, so it needs no cooperation and stops within
/// microseconds.
class LightProcess final : public LightComputation {
 public:
  /// Starts `command`, the program's path followed by its arguments. Errors: kNotFound or kSystem.
  static Result<std::unique_ptr<LightComputation>> start(const std::vector<std::string>& command);
  ~LightProcess() override;

  void pause() override;
  void resume() override;
  [[nodiscard]] double done_share() override;
  [[nodiscard]] std::optional<Status> result() override;

 private:
  LightProcess(pid_t process, UniqueFd output) : process_(process), output_(std::move(output)) {}
  void read_output();
  void read_line(const std::string& line);
  void send_signal(int number) const;

  std::atomic<pid_t> process_;  ///< 0 once the process has ended.
  UniqueFd output_;
  std::string unread_;  ///< Beginning of an incomplete line.
  std::string error_;
  double done_share_ = 0.0;
};

}  // namespace cyclorama::node
