// SPDX-License-Identifier: Apache-2.0
/// V4L2 cameras described as data, in place of the kernel's. A program that links fake_video gets them instead of the
/// machine's (by the linker's --wrap of open, ioctl, mmap...). Time is that of the fake clock, which advances by
/// waiting.
///
///   FakeClock clock;
///   FakeVideo video({usb_camera()}, &clock);
///   auto camera = V4l2Camera::open(...);
///   video.fail("VIDIOC_S_FMT", EBUSY);              // Fails the next call of that name, once.
///   video.fail_nth(7, EIO);                         // Fails the seventh call from now, whatever it is.
///   video.unplug(0);
#pragma once

#include <linux/videodev2.h>

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/base/unique_fd.h"
#include "common/image/image.h"
#include "tests/doubles/fake_clock.h"

namespace cyclorama {

struct FakeSize {
  int width = 640;
  int height = 480;
  std::vector<double> rates{30.0};  ///< Empty if the driver reports none.
};

struct FakeFormat {
  std::uint32_t fourcc = V4L2_PIX_FMT_YUYV;
  std::vector<FakeSize> sizes{{}};  ///< Empty if the driver lists no sizes and has only that of its signal, 640x480.
};

struct FakeControl {
  long min = 0;
  long max = 1;
  long step = 1;
  long value = 0;
};

struct FakeVideoDevice {
  std::string path = "/dev/video0";
  std::string port = "usb-0000:00:14.0-2";
  std::string name = "Fake camera";
  std::uint32_t can = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
  std::vector<FakeFormat> formats{{}};
  bool has_ranges = false;  ///< True: sizes from 16x16 to 4096x4096 in steps of 8, and rates from 1 to 120.
  std::map<std::uint32_t, FakeControl> controls;
  std::uint32_t stamp_flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  Duration exposure = std::chrono::milliseconds(4);  ///< Exposure time; it ends when the picture is ready.
  std::uint32_t row_padding = 0;
  bool is_grabber = false;  ///< True for a grabber, whose size is that of its signal.
  bool has_signal = true;
  bool exports_dma_bufs = true;
  /// Returns the scene for the exposure time of the control in seconds; only for YUYV, in the format's size. Empty:
  /// fake_level() is used.
  std::function<RgbImage(double)> sees = {};
};

/// Returns a typical camera: YUYV at 30 per second in VGA, JPEG at 30 per second in all sizes, controls for exposure
/// and gain.
FakeVideoDevice usb_camera();
/// Returns a machine-vision camera: grey, any size.
FakeVideoDevice grey_camera();

/// Returns the grey level of a pixel of picture number `sequence`.
[[nodiscard]] std::uint8_t fake_level(std::uint32_t sequence, int x, int y);

/// The whole fake machine, as long as this object exists. Only one may exist at a time. Bound to the camera's thread.
class FakeVideo {
 public:
  FakeVideo(std::vector<FakeVideoDevice> devices, FakeClock* clock);
  ~FakeVideo();
  FakeVideo(const FakeVideo&) = delete;
  FakeVideo& operator=(const FakeVideo&) = delete;

  /// Returns a device, which may be changed at any time.
  FakeVideoDevice& device(std::size_t number) { return devices_.at(number)->device; }
  void unplug(std::size_t number);
  void plug(std::size_t number) { devices_.at(number)->is_plugged = true; }
  /// Simulates another program that begins or ends streaming from the device.
  void set_taken(std::size_t number, bool is_taken) { devices_.at(number)->is_taken = is_taken; }
  /// Stops the pictures without an error, or continues them.
  void set_stalled(std::size_t number, bool is_stalled) { devices_.at(number)->is_stalled = is_stalled; }
  /// Sets V4L2_BUF_FLAG_ERROR on the next pictures.
  void damage(std::size_t number, int pictures) { devices_.at(number)->damaged = pictures; }
  /// Truncates the next pictures.
  void shorten(std::size_t number, int pictures) { devices_.at(number)->shortened = pictures; }
  /// Simulates a change of the signal's format, which causes a source change event.
  void change_source(std::size_t number) { devices_.at(number)->has_event = true; }

  /// Lets `passes` calls of this name succeed and makes the next one fail with this errno.
  void fail(const std::string& call, int error, int passes = 0) { fault_ = Fault{call, error, passes}; }
  void fail_nth(int nth, int error) { fault_ = Fault{"", error, nth - 1}; }
  [[nodiscard]] bool was_fault_met() const { return !fault_; }
  /// Returns the call that failed.
  [[nodiscard]] const std::string& failed_call() const { return failed_call_; }

  /// Returns the number of open files, exported buffers and maps, and of devices that still have buffers.
  [[nodiscard]] std::size_t held() const;
  /// Returns the number of calls of each function.
  [[nodiscard]] const std::map<std::string, int>& calls() const { return calls_; }

  // The members below are for the wrapped calls only.

  struct Buffer {
    UniqueFd memory;
    bool is_queued = false;
    v4l2_buffer filled{};
  };
  struct DeviceState {
    FakeVideoDevice device;
    std::size_t number = 0;
    bool is_plugged = true;
    bool is_taken = false;
    bool is_stalled = false;
    bool has_event = false;
    int damaged = 0;
    int shortened = 0;
    v4l2_pix_format format{};
    v4l2_fract interval{1, 30};
    int owner_fd = -1;  ///< File descriptor that owns the buffers; -1 if there are none.
    bool is_streaming = false;
    std::vector<Buffer> buffers;
    std::deque<std::uint32_t> queued;
    std::deque<std::uint32_t> filled;
    TimePoint next_at{};
    std::uint32_t sequence = 0;
  };

  static FakeVideo* the_or_null();
  /// Returns the errno with which this call must fail; 0 if it must succeed.
  int meet(const char* call);
  DeviceState* device_of(int fd);
  DeviceState* device_at(const std::string& path);
  void opened(int fd, DeviceState* device) { fds_[fd] = device; }
  void closed(int fd);
  /// Exposes and fills the pictures that are due.
  void run(DeviceState* device);
  void free_buffers(DeviceState* device);
  /// Performs a V4L2 request. Returns an errno, or 0.
  int request(DeviceState* device, int fd, unsigned long code, void* argument);
  [[nodiscard]] FakeClock& clock() { return *clock_; }

  std::set<void*> maps;
  std::set<int> exported;

 private:
  struct Fault {
    std::string call;  ///< Empty matches any call.
    int error = 0;
    int passes = 0;
  };
  void fill(DeviceState* device, std::uint32_t index);

  std::vector<std::unique_ptr<DeviceState>> devices_;
  std::map<int, DeviceState*> fds_;
  FakeClock* clock_;
  std::optional<Fault> fault_;
  std::string failed_call_;
  std::map<std::string, int> calls_;
};

}  // namespace cyclorama
