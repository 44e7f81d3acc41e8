// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>

#include "drivers/turntable/manual/manual_turntable.h"

namespace cyclorama::calibrator {

/// Passes the questions of a manual turntable to the calibration's client, which answers them. Clients are the terminal
/// of `cyclorama calibrate` and the operator's page. Thread-safe.
class TurntablePrompt {
 public:
  /// Called with a new question, again every fifth of a second while the question is open, and with an empty text once
  /// it is answered, by the thread that waits for the answer. Returns false if the calibration is no longer needed.
  using Listener = std::function<bool(const std::string& question)>;

  /// Sets the listener when a calibration begins; null when it has ended.
  void set_listener(Listener listener);
  /// Answers the open question. Returns false if there is none. An empty text means that the turntable was turned as
  /// requested.
  bool answer(const std::string& text);
  /// See TurntableOperator::answer().
  Result<std::string> ask(const std::string& question, std::chrono::milliseconds timeout);

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  Listener listener_;
  bool is_open_ = false;
  std::optional<std::string> answer_;
};

/// Adapts a TurntablePrompt to ManualTurntable. Borrows the prompt.
class PromptOperator final : public turntable::TurntableOperator {
 public:
  explicit PromptOperator(TurntablePrompt* prompt) : prompt_(*prompt) {}
  Result<std::string> answer(const std::string& question, std::chrono::milliseconds timeout) override {
    return prompt_.ask(question, timeout);
  }

 private:
  TurntablePrompt& prompt_;
};

}  // namespace cyclorama::calibrator
