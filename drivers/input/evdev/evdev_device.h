// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/input/input_watch.h"

namespace cyclorama::input {

/// A device of the kernel's input layer, read beside whoever else reads it.
///
/// kNotFound, kSystem  it cannot be opened: the rule in systemd/udev gives the group `input` access.
/// kBadData  a file that is no such device.
Result<std::unique_ptr<InputDevice>> open_evdev(const std::string& path);

/// All of a folder, by default the machine's: "/dev/input".
[[nodiscard]] InputDevices evdev_devices(const std::string& folder);

}  // namespace cyclorama::input
