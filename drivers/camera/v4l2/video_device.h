// SPDX-License-Identifier: Apache-2.0
/// One open V4L2 capture device: its identity, offers and settings. Internal to the V4L2 camera.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/base/unique_fd.h"
#include "drivers/camera/picture_choice.h"

namespace cyclorama::camera {

/// Performs an ioctl and repeats it while a signal interrupts it. Returns false on failure, with the reason in errno.
bool device_call(int fd, unsigned long request, void* argument);

/// Translates errno after a device request.
///
/// kUnavailable  unplugged, or the bus has too little bandwidth for the pictures.
/// kBusy         another program streams from the device.
/// kNotFound     no such device.
/// kSystem       all other errors.
Error device_error(const std::string& doing, SourceLine where = SourceLine::current());

/// The picture format that the driver selected for an offer.
struct PictureFormat {
  std::uint32_t fourcc = 0;
  PixelLayout layout = PixelLayout::kGrey8;
  int width = 0;
  int height = 0;
  std::size_t row_bytes = 0;
  ColourCode colour{};
};

/// A control that the device lets us set. The entries of a menu control are its numbers.
struct DeviceControl {
  std::uint32_t id = 0;
  long min = 0;
  long max = 0;
  long step = 1;
  long value = 0;
};

/// An open V4L2 capture device. Every Error names its path and port. Thread-bound.
class VideoDevice {
 public:
  /// Errors: kNotFound also if the device captures no video or only multi-planar formats; others are those of
  /// device_error().
  static Result<VideoDevice> open(const std::string& path);

  [[nodiscard]] int fd() const { return fd_.get(); }
  [[nodiscard]] const std::string& path() const { return path_; }
  /// Bus position reported by the kernel ("usb-0000:00:14.0-2"); unchanged after a restart or a re-plug.
  [[nodiscard]] const std::string& port() const { return port_; }
  [[nodiscard]] const std::string& name() const { return name_; }
  /// Device number assigned by the kernel; identifies the device under any path.
  [[nodiscard]] std::uint64_t number() const { return number_; }

  /// Returns the readable formats that the device offers. For sizes and rates offered as a range, the preferred or
  /// nearest value is used.
  Result<std::vector<PictureOffer>> offers(const PicturePreference& preferred) const;
  /// Adopts the timings of the signal at a frame grabber's input; does nothing for a camera.
  /// Errors: kUnavailable if there is no signal.
  Status follow_signal() const;
  /// Errors: kBusy if another program streams; kBadData if the driver selects a pixel format that cannot be read.
  Result<PictureFormat> set_format(const PictureOffer& offer) const;
  /// Returns the rate that the driver selected; nothing if it does not support setting one.
  Result<std::optional<double>> set_rate(double frames_per_second) const;
  /// Subscribes to changes of the signal's format, if the driver supports it; they raise POLLPRI.
  void subscribe_to_source_changes() const;
  /// Dequeues one event; returns true if it announces another format of the pictures.
  [[nodiscard]] bool took_source_change() const;

  /// Returns a control; nothing if the device does not have it or currently disables it.
  [[nodiscard]] std::optional<DeviceControl> control(std::uint32_t id) const;
  /// Returns whether the device accepted the value. Errors: kUnavailable if the device is gone.
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
