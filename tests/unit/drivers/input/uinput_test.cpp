// SPDX-License-Identifier: Apache-2.0
/// A device that the kernel makes through uinput, where permitted: plugged in, moved, unplugged.
#include <gtest/gtest.h>
#include <libevdev/libevdev-uinput.h>
#include <libevdev/libevdev.h>
#include <poll.h>

#include "drivers/input/evdev/evdev_device.h"

namespace cyclorama::input {
namespace {

/// Returns null if there is no /dev/uinput.
libevdev_uinput* plug_keyboard() {
  libevdev* const device = libevdev_new();
  libevdev_set_name(device, "cyclorama test keys");
  for (const int key : {KEY_UP, KEY_LEFT, KEY_W})
    libevdev_enable_event_code(device, EV_KEY, static_cast<unsigned>(key), nullptr);
  libevdev_uinput* made = nullptr;
  libevdev_uinput_create_from_device(device, LIBEVDEV_UINPUT_OPEN_MANAGED, &made);
  libevdev_free(device);
  return made;
}

TEST(Uinput, devices_are_followed_from_plugging_to_unplugging) {
  libevdev_uinput* const keys = plug_keyboard();
  if (keys == nullptr) GTEST_SKIP() << "no /dev/uinput here";
  auto device = open_evdev(libevdev_uinput_get_devnode(keys));
  ASSERT_TRUE(device) << device.error().message();
  EXPECT_EQ(kind_of((*device)->description()), InputKind::kKeyboard);
  libevdev_uinput_write_event(keys, EV_KEY, KEY_UP, 1);
  libevdev_uinput_write_event(keys, EV_SYN, SYN_REPORT, 0);
  std::optional<InputEvent> seen;
  for (int i = 0; i < 200 && !(seen && seen->code == KEY_UP); ++i) {
    const auto event = (*device)->next();
    ASSERT_TRUE(event);
    seen = *event;
    if (!seen) ::poll(nullptr, 0, 10);
  }
  ASSERT_TRUE(seen);
  EXPECT_EQ(seen->value, 1);
  libevdev_uinput_destroy(keys);
  bool gone = false;
  for (int i = 0; i < 200 && !gone; ++i) {
    gone = !(*device)->next();
    if (!gone) ::poll(nullptr, 0, 10);
  }
  EXPECT_TRUE(gone);
}

}  // namespace
}  // namespace cyclorama::input
