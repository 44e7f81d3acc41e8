// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>

#include "drivers/turntable/manual/manual_turntable.h"

namespace cyclorama::calibrator {

/// Where a turntable that a person turns asks, and the calibration's client answers: the terminal of `cyclorama
/// calibrate`, or the operator's page. Thread-safe.
class TurntablePrompt {
 public:
  /// Hears a new question, and every fifth of a second that it is still open; empty: it is answered. False: nobody
  /// wants the calibration any more. Called by the thread that asks.
  using Listener = std::function<bool(const std::string& question)>;

  /// Of the calibration that begins; null: it has ended.
  void set_listener(Listener listener);
  /// False: nothing is asked. "" means done as it was asked.
  bool answer(const std::string& text);
  /// As TurntableOperator::answer().
  Result<std::string> ask(const std::string& question, std::chrono::milliseconds timeout);

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  Listener listener_;
  bool is_open_ = false;
  std::optional<std::string> answer_;
};

/// What a ManualTurntable asks through. Borrows the prompt.
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
