// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "common/base/result.h"

struct udev;
struct udev_monitor;

namespace cyclorama::output {

/// Reports changes at the connectors of any card. Move-only, thread-bound.
class HotplugMonitor {
 public:
  /// Listens to kernel uevents directly, so that no udev daemon is needed. Errors: kSystem with the text of errno.
  static Result<HotplugMonitor> open();

  /// Returns whether any event has arrived since the last call. Never blocks.
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
