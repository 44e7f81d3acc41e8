// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/base/clock.h"

namespace cyclorama {

/// Long work, for a person: a bar on a terminal, else a plain line every ten percent. Standard error. Thread-bound.
class Progress {
 public:
  explicit Progress(std::string what);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// What is being done now; a plain line comes with the next update.
  void set_step(const std::string& what);
  /// `fraction` in [0, 1], never less than before.
  void update(double fraction);

 private:
  std::string what_;
  bool terminal_;
  bool is_new_step_ = false;
  double shown_ = -1.0;
  TimePoint drawn_at_{};
};

}  // namespace cyclorama
