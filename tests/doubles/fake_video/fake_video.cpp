// SPDX-License-Identifier: Apache-2.0
#include "tests/doubles/fake_video/fake_video.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "common/base/check.h"
#include "common/image/jpeg.h"

namespace cyclorama {
namespace {

FakeVideo* the_video = nullptr;

Duration period_of(const v4l2_fract& interval) {
  return std::chrono::nanoseconds(1'000'000'000LL * interval.numerator / std::max(interval.denominator, 1U));
}

/// Encodes by ITU-R BT.601, with luma from 16 to 235 and shared chroma for each two pixels.
std::vector<std::byte> encode_yuyv(const v4l2_pix_format& format, const RgbImage& picture) {
  CHECK(format.pixelformat == V4L2_PIX_FMT_YUYV && picture.width() == static_cast<int>(format.width) &&
        picture.height() == static_cast<int>(format.height));
  const auto code = [](double value) { return static_cast<std::byte>(std::lround(std::clamp(value, 1.0, 254.0))); };
  std::vector<std::byte> bytes(format.sizeimage, std::byte{128});
  for (int y = 0; y < picture.height(); ++y) {
    std::byte* const row = bytes.data() + static_cast<std::size_t>(y) * format.bytesperline;
    for (int x = 0; x + 1 < picture.width(); x += 2) {
      double blue = 0.0;
      double red = 0.0;
      for (int k = 0; k < 2; ++k) {
        const std::uint8_t* const p = picture.at(x + k, y);
        const double luma = 0.299 * p[0] + 0.587 * p[1] + 0.114 * p[2];
        row[2 * (x + k)] = code(16.0 + 219.0 / 255.0 * luma);
        blue += 0.5 * (p[2] - luma) / 1.772;
        red += 0.5 * (p[0] - luma) / 1.402;
      }
      row[2 * x + 1] = code(128.0 + 224.0 / 255.0 * blue);
      row[2 * x + 3] = code(128.0 + 224.0 / 255.0 * red);
    }
  }
  return bytes;
}

/// Encodes the fake's grey levels in the pixel format; chroma is 128.
std::vector<std::byte> encode(const v4l2_pix_format& format, std::uint32_t sequence) {
  const auto width = static_cast<int>(format.width);
  const auto height = static_cast<int>(format.height);
  if (format.pixelformat == V4L2_PIX_FMT_MJPEG) {
    RgbImage picture(width, height);
    for (int y = 0; y < height; ++y) {
      // The picture is plain, so that JPEG compression preserves it.
      for (int x = 0; x < width; ++x) std::fill_n(picture.at(x, y), 3, fake_level(sequence, 0, 0));
    }
    JpegEncoder encoder;
    auto jpeg = encoder.encode(picture, {90, true});
    CHECK(jpeg.has_value());
    return *std::move(jpeg);
  }
  std::vector<std::byte> bytes(format.sizeimage, std::byte{128});
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t row = static_cast<std::size_t>(y) * format.bytesperline;
      const auto column = static_cast<std::size_t>(x);
      const auto level = static_cast<std::byte>(fake_level(sequence, x, y));
      switch (format.pixelformat) {
        case V4L2_PIX_FMT_YUYV:
          bytes[row + 2 * column] = level;
          break;
        case V4L2_PIX_FMT_UYVY:
        case V4L2_PIX_FMT_Y16:  // The low byte does not matter.
          bytes[row + 2 * column + 1] = level;
          break;
        default:
          bytes[row + column] = level;
      }
    }
  }
  return bytes;
}

}  // namespace

std::uint8_t fake_level(std::uint32_t sequence, int x, int y) {
  return static_cast<std::uint8_t>((20U + 7U * sequence + static_cast<unsigned>(x) + 3U * static_cast<unsigned>(y)) %
                                   200U);
}

FakeVideoDevice usb_camera() {
  FakeVideoDevice device;
  device.formats = {{V4L2_PIX_FMT_YUYV, {{640, 480, {30.0, 15.0}}, {1280, 720, {10.0}}}},
                    {V4L2_PIX_FMT_MJPEG, {{640, 480, {60.0, 30.0}}, {1280, 720, {30.0}}}},
                    {V4L2_PIX_FMT_H264, {{1920, 1080, {60.0}}}}};
  device.controls = {{V4L2_CID_EXPOSURE_AUTO, {0, 3, 1, V4L2_EXPOSURE_APERTURE_PRIORITY}},
                     {V4L2_CID_EXPOSURE_AUTO_PRIORITY, {0, 1, 1, 1}},
                     {V4L2_CID_EXPOSURE_ABSOLUTE, {3, 2047, 1, 250}},
                     {V4L2_CID_GAIN, {0, 255, 5, 0}}};
  return device;
}

FakeVideoDevice grey_camera() {
  FakeVideoDevice device;
  device.path = "/dev/video2";
  device.port = "usb-0000:00:14.0-7";
  device.name = "Fake machine vision";
  device.formats = {{V4L2_PIX_FMT_GREY, {}}};
  device.has_ranges = true;
  device.stamp_flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_EOF;
  device.row_padding = 24;
  return device;
}

FakeVideo::FakeVideo(std::vector<FakeVideoDevice> devices, FakeClock* clock) : clock_(clock) {
  CHECK(the_video == nullptr);
  the_video = this;
  for (FakeVideoDevice& device : devices) {
    devices_.push_back(std::make_unique<DeviceState>());
    devices_.back()->device = std::move(device);
    devices_.back()->number = devices_.size() - 1;
  }
}

FakeVideo::~FakeVideo() {
  for (const auto& device : devices_) free_buffers(device.get());
  the_video = nullptr;
}

FakeVideo* FakeVideo::the_or_null() { return the_video; }

void FakeVideo::unplug(std::size_t number) {
  devices_.at(number)->is_plugged = false;
  devices_.at(number)->is_streaming = false;
}

int FakeVideo::meet(const char* call) {
  ++calls_[call];
  if (!fault_ || (!fault_->call.empty() && fault_->call != call) || fault_->passes-- > 0) return 0;
  const int error = fault_->error;
  failed_call_ = call;
  fault_.reset();
  return error;
}

FakeVideo::DeviceState* FakeVideo::device_of(int fd) {
  const auto found = fds_.find(fd);
  return found == fds_.end() ? nullptr : found->second;
}

FakeVideo::DeviceState* FakeVideo::device_at(const std::string& path) {
  for (const auto& device : devices_) {
    if (device->device.path == path) return device.get();
  }
  return nullptr;
}

void FakeVideo::closed(int fd) {
  exported.erase(fd);
  const auto found = fds_.find(fd);
  if (found == fds_.end()) return;
  DeviceState* const device = found->second;
  fds_.erase(found);
  // The kernel frees the file's buffers.
  if (device->owner_fd == fd) free_buffers(device);
}

void FakeVideo::free_buffers(DeviceState* device) {
  device->buffers.clear();
  device->queued.clear();
  device->filled.clear();
  device->is_streaming = false;
  device->owner_fd = -1;
}

std::size_t FakeVideo::held() const {
  const auto with_buffers =
      std::count_if(devices_.begin(), devices_.end(), [](const auto& device) { return !device->buffers.empty(); });
  return fds_.size() + exported.size() + maps.size() + static_cast<std::size_t>(with_buffers);
}

void FakeVideo::run(DeviceState* device) {
  while (device->is_streaming && device->next_at <= clock_->now()) {
    if (!device->is_stalled && !device->queued.empty()) {
      const std::uint32_t index = device->queued.front();
      device->queued.pop_front();
      fill(device, index);
      device->filled.push_back(index);
    }
    ++device->sequence;
    device->next_at += period_of(device->interval);
  }
}

void FakeVideo::fill(DeviceState* device, std::uint32_t index) {
  Buffer& buffer = device->buffers[index];
  if (device->device.sees) {
    // The control has a unit of 100 us.
    device->device.exposure =
        std::chrono::microseconds(100 * device->device.controls[V4L2_CID_EXPOSURE_ABSOLUTE].value);
  }
  const std::vector<std::byte> bytes =
      device->device.sees ? encode_yuyv(device->format, device->device.sees(to_seconds(device->device.exposure)))
                          : encode(device->format, device->sequence);
  CHECK(bytes.size() <= device->format.sizeimage);
  CHECK(::pwrite(buffer.memory.get(), bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size()));
  v4l2_buffer& filled = buffer.filled;
  filled = {};
  filled.index = index;
  filled.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  filled.memory = V4L2_MEMORY_MMAP;
  filled.bytesused = static_cast<std::uint32_t>(bytes.size());
  filled.length = device->format.sizeimage;
  filled.sequence = device->sequence;
  filled.flags = device->device.stamp_flags;
  const bool is_start = (device->device.stamp_flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  const TimePoint at = is_start ? device->next_at - device->device.exposure : device->next_at;
  const auto us = std::chrono::duration_cast<std::chrono::microseconds>(at.time_since_epoch()).count();
  filled.timestamp.tv_sec = us / 1'000'000;
  filled.timestamp.tv_usec = us % 1'000'000;
  if (device->damaged > 0) {
    --device->damaged;
    filled.flags |= V4L2_BUF_FLAG_ERROR;
  }
  if (device->shortened > 0) {
    --device->shortened;
    filled.bytesused /= 2;
  }
}

}  // namespace cyclorama
