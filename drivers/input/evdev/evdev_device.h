// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/input/input_watch.h"

namespace cyclorama::input {

/// Opens a device of the kernel's input layer, without exclusive access.
///
/// Errors: kNotFound or kSystem if it cannot be opened (the rule in systemd/udev grants access to the group `input`);
/// kBadData if the file is not an input device.
Result<std::unique_ptr<InputDevice>> open_evdev(const std::string& path);

/// Returns all devices of a folder, usually "/dev/input".
[[nodiscard]] InputDevices evdev_devices(const std::string& folder);

}  // namespace cyclorama::input
