// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "common/base/result.h"

struct udev;
struct udev_monitor;

namespace cyclorama::output {

/// Hears when something changes at a connector of any card. Move-only, thread-bound.
class HotplugMonitor {
 public:
  /// Listens to the kernel itself, so that it needs no udev daemon. kSystem  errno says why.
  static Result<HotplugMonitor> open();

  /// Whether anything was heard since the last call. Never blocks.
  [[nodiscard]] bool take();

 private:
  HotplugMonitor() = default;
  struct Free {
    void operator()(udev* context) const;
    void operator()(udev_monitor* monitor) const;
  };
  std::unique_ptr<udev, Free> context_;
  std::unique_ptr<udev_monitor, Free> monitor_;
};

}  // namespace cyclorama::output
