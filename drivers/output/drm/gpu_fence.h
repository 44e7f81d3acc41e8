// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "common/base/clock.h"
#include "common/base/unique_fd.h"

namespace cyclorama::output {

/// The point at which the GPU has executed all commands that were issued until now: a sync file, for which a card's
/// commit can wait by itself. Move-only; reentrant.
class GpuFence {
 public:
  explicit GpuFence(UniqueFd file) : file_(std::move(file)) {}

  [[nodiscard]] int fd() const { return file_.get(); }
  /// Returns when the GPU reached the fence, on CLOCK_MONOTONIC; nothing if it has not, or if the driver does not tell.
  [[nodiscard]] std::optional<TimePoint> reached_at() const;

 private:
  UniqueFd file_;
};

}  // namespace cyclorama::output
