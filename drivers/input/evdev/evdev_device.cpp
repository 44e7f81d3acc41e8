// SPDX-License-Identifier: Apache-2.0
#include "drivers/input/evdev/evdev_device.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <libevdev/libevdev.h>

#include <cerrno>
#include <filesystem>
#include <utility>

#include "common/base/unique_fd.h"

namespace cyclorama::input {
namespace {

struct FreeEvdev {
  void operator()(libevdev* device) const { libevdev_free(device); }
};
using Evdev = std::unique_ptr<libevdev, FreeEvdev>;

InputDescription describe(const libevdev* device) {
  InputDescription description;
  const char* const name = libevdev_get_name(device);
  description.name = name == nullptr ? "" : name;
  for (unsigned code = 0; code <= KEY_MAX; ++code) {
    if (libevdev_has_event_code(device, EV_KEY, code) == 1) description.keys.insert(static_cast<int>(code));
  }
  for (unsigned code = 0; code <= REL_MAX; ++code) {
    if (libevdev_has_event_code(device, EV_REL, code) == 1) description.relative.insert(static_cast<int>(code));
  }
  for (unsigned code = 0; code <= ABS_MAX; ++code) {
    if (libevdev_has_event_code(device, EV_ABS, code) != 1) continue;
    description.absolute[static_cast<int>(code)] = {libevdev_get_abs_minimum(device, code),
                                                    libevdev_get_abs_maximum(device, code)};
  }
  return description;
}

class EvdevDevice final : public InputDevice {
 public:
  EvdevDevice(UniqueFd fd, Evdev device)
      : fd_(std::move(fd)), device_(std::move(device)), description_(describe(device_.get())) {}

  [[nodiscard]] const InputDescription& description() const override { return description_; }
  Result<std::optional<InputEvent>> next() override {
    input_event event{};
    // After events were lost (SYN_DROPPED), libevdev delivers the current state as events, too.
    const unsigned flag = syncing_ ? LIBEVDEV_READ_FLAG_SYNC : LIBEVDEV_READ_FLAG_NORMAL;
    const int code = libevdev_next_event(device_.get(), flag, &event);
    if (code == -EAGAIN && syncing_) {
      syncing_ = false;
      return next();
    }
    if (code == -EAGAIN || code == -EINTR) return std::optional<InputEvent>{};
    if (code < 0) {
      errno = -code;
      return Error(ErrorCode::kUnavailable, fmt::format("the input device '{}' is gone", description_.name));
    }
    syncing_ = code == LIBEVDEV_READ_STATUS_SYNC;
    return std::optional<InputEvent>(InputEvent{event.type, event.code, event.value});
  }

 private:
  UniqueFd fd_;
  Evdev device_;
  InputDescription description_;
  bool syncing_ = false;
};

}  // namespace

Result<std::unique_ptr<InputDevice>> open_evdev(const std::string& path) {
  UniqueFd fd(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  if (fd.get() < 0) return Error::from_errno(fmt::format("opening the input device '{}'", path));
  libevdev* device = nullptr;
  const int code = libevdev_new_from_fd(fd.get(), &device);
  if (code < 0) {
    return Error(ErrorCode::kBadData, fmt::format("'{}' is no input device of the kernel's", path));
  }
  return std::unique_ptr<InputDevice>(std::make_unique<EvdevDevice>(std::move(fd), Evdev(device)));
}

InputDevices evdev_devices(const std::string& folder) {
  return {[folder] {
            std::vector<std::string> paths;
            std::error_code error;
            for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
              if (entry.path().filename().string().starts_with("event")) paths.push_back(entry.path().string());
            }
            return paths;
          },
          open_evdev};
}

}  // namespace cyclorama::input
