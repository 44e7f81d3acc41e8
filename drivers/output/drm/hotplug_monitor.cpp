// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/drm/hotplug_monitor.h"

#include <libudev.h>

#include "drivers/output/drm/kms.h"

namespace cyclorama::output {

void HotplugMonitor::Free::operator()(udev* context) const { udev_unref(context); }
void HotplugMonitor::Free::operator()(udev_monitor* monitor) const { udev_monitor_unref(monitor); }

Result<HotplugMonitor> HotplugMonitor::open() {
  HotplugMonitor opened;
  opened.context_.reset(udev_new());
  if (opened.context_ == nullptr) return Error::from_errno("starting udev");
  opened.monitor_.reset(udev_monitor_new_from_netlink(opened.context_.get(), "kernel"));
  if (opened.monitor_ == nullptr) return Error::from_errno("listening to the kernel's events");
  const int filtered = udev_monitor_filter_add_match_subsystem_devtype(opened.monitor_.get(), "drm", nullptr);
  if (filtered < 0) return kms_error(filtered, "choosing the events of graphics cards");
  const int enabled = udev_monitor_enable_receiving(opened.monitor_.get());
  if (enabled < 0) return kms_error(enabled, "listening to the kernel's events");
  return opened;
}

bool HotplugMonitor::take() {
  bool was_heard = false;
  // The socket is non-blocking, and the contents of an event are irrelevant, since the caller probes all connectors.
  while (udev_device* const device = udev_monitor_receive_device(monitor_.get())) {
    udev_device_unref(device);
    was_heard = true;
  }
  return was_heard;
}

}  // namespace cyclorama::output
