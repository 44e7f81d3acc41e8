// SPDX-License-Identifier: Apache-2.0
/// One open V4L2 capture device: what it is, what it offers, how it is set. Internal to the V4L2 camera.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/base/unique_fd.h"
#include "drivers/camera/picture_choice.h"

namespace cyclorama::camera {

/// One request to the kernel, again while a signal interrupts it. False: errno says why.
bool device_call(int fd, unsigned long request, void* argument);

/// errno of a request to a device, for people.
///
/// kUnavailable  it is gone (unplugged), or its bus has no room for its pictures.
/// kBusy         another program streams from it.
/// kNotFound     no such device.
/// kSystem       all else.
Error device_error(const std::string& doing, SourceLine where = SourceLine::current());

/// What the driver made of a preferred.
struct PictureFormat {
  std::uint32_t fourcc = 0;
  PixelLayout layout = PixelLayout::kGrey8;
  int width = 0;
  int height = 0;
  std::size_t row_bytes = 0;
  ColourCode colour{};
};

/// A number that the device lets us set. A menu's entries are its numbers.
struct DeviceControl {
  std::uint32_t id = 0;
  long min = 0;
  long max = 0;
  long step = 1;
  long value = 0;
};

/// Thread-bound. Every Error names the device's path and port.
class VideoDevice {
 public:
  /// kNotFound  also when it captures no video, or only with several planes of memory per picture.
  /// Others as device_error().
  static Result<VideoDevice> open(const std::string& path);

  [[nodiscard]] int fd() const { return fd_.get(); }
  [[nodiscard]] const std::string& path() const { return path_; }
  /// Where it is plugged in, in the kernel's words ("usb-0000:00:14.0-2"): the same after a restart and a re-plug.
  [[nodiscard]] const std::string& port() const { return port_; }
  [[nodiscard]] const std::string& name() const { return name_; }
  /// The kernel's number of it: one device, whatever the path.
  [[nodiscard]] std::uint64_t number() const { return number_; }

  /// What can be read of what it sends. Of sizes and rates that it offers by range, the preferred or what is nearest to it.
  Result<std::vector<PictureOffer>> offers(const PicturePreference& preferred) const;
  /// For what is plugged into a frame grabber: takes the signal's timings. Nothing to do for a camera.
  /// kUnavailable  no signal.
  Status follow_signal() const;
  /// kBusy     another program streams.
  /// kBadData  the driver answers with pixels that cannot be read.
  Result<PictureFormat> set_format(const PictureOffer& offer) const;
  /// The rate that the driver made of it; nothing where it has none to set.
  Result<std::optional<double>> set_rate(double frames_per_second) const;
  /// Asks to be told when the signal's shape changes, if the driver can; POLLPRI then.
  void subscribe_to_source_changes() const;
  /// Takes one event. Whether it says that the pictures will have another shape.
  [[nodiscard]] bool took_source_change() const;

  /// Nothing when the device has no such control, or keeps it to itself now.
  [[nodiscard]] std::optional<DeviceControl> control(std::uint32_t id) const;
  /// Whether the device took it; kUnavailable when it is gone.
  Result<bool> set_control(std::uint32_t id, long value) const;

 private:
  [[nodiscard]] std::string named(const std::string& doing) const;
  void add_sizes(std::uint32_t fourcc, PixelLayout layout, const PicturePreference& preferred,
                 std::vector<PictureOffer>* ret_offers) const;
  void add_rates(PictureOffer offer, const PicturePreference& preferred, std::vector<PictureOffer>* ret_offers) const;

  UniqueFd fd_;
  std::string path_;
  std::string port_;
  std::string name_;
  std::uint64_t number_ = 0;
};

}  // namespace cyclorama::camera
