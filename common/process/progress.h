// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/base/clock.h"

namespace cyclorama {

/// Progress of long work on standard error: a bar on a terminal, otherwise a plain line every ten percent.
/// Thread-bound.
class Progress {
 public:
  explicit Progress(std::string what);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// Sets the current step; on a plain output, its line follows with the next update.
  void set_step(const std::string& what);
  /// `fraction` is in [0, 1] and never decreases.
  void update(double fraction);

 private:
  std::string what_;
  bool terminal_;
  bool is_new_step_ = false;
  double shown_ = -1.0;
  TimePoint drawn_at_{};
};

}  // namespace cyclorama
