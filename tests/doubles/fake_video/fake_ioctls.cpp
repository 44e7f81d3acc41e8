// SPDX-License-Identifier: Apache-2.0
// V4L2 requests as in the kernel's documentation, as far as a camera driver and tests of its errors need them.
#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "common/base/check.h"
#include "tests/doubles/fake_video/fake_video.h"

namespace cyclorama {
namespace {

using Device = FakeVideo::DeviceState;

std::size_t bytes_per_pixel(std::uint32_t fourcc) {
  return fourcc == V4L2_PIX_FMT_YUYV || fourcc == V4L2_PIX_FMT_UYVY || fourcc == V4L2_PIX_FMT_Y16 ? 2 : 1;
}

const FakeFormat* format_of(const Device& device, std::uint32_t fourcc) {
  for (const FakeFormat& format : device.device.formats) {
    if (format.fourcc == fourcc) return &format;
  }
  return nullptr;
}

v4l2_fract interval_of(double rate) { return {1000, static_cast<std::uint32_t>(std::lround(1000.0 * rate))}; }

template <std::size_t N>
void put_text(const std::string& text, unsigned char (&field)[N]) {
  std::memcpy(field, text.data(), std::min(text.size(), N - 1));
}

int query_capability(const Device& device, v4l2_capability* ret) {
  *ret = {};
  put_text(device.device.name, ret->card);
  put_text(device.device.port, ret->bus_info);
  ret->device_caps = device.device.can;
  ret->capabilities = device.device.can | V4L2_CAP_DEVICE_CAPS;
  return 0;
}

int list_format(const Device& device, v4l2_fmtdesc* ret) {
  if (ret->index >= device.device.formats.size()) return EINVAL;
  ret->pixelformat = device.device.formats[ret->index].fourcc;
  return 0;
}

int list_size(const Device& device, v4l2_frmsizeenum* ret) {
  const FakeFormat* const format = format_of(device, ret->pixel_format);
  if (format == nullptr) return EINVAL;
  if (device.device.has_ranges) {
    if (ret->index != 0) return EINVAL;
    ret->type = V4L2_FRMSIZE_TYPE_STEPWISE;
    ret->stepwise = {16, 4096, 8, 16, 4096, 8};
    return 0;
  }
  if (ret->index >= format->sizes.size()) return EINVAL;
  ret->type = V4L2_FRMSIZE_TYPE_DISCRETE;
  ret->discrete.width = static_cast<std::uint32_t>(format->sizes[ret->index].width);
  ret->discrete.height = static_cast<std::uint32_t>(format->sizes[ret->index].height);
  return 0;
}

int list_interval(const Device& device, v4l2_frmivalenum* ret) {
  const FakeFormat* const format = format_of(device, ret->pixel_format);
  if (format == nullptr) return EINVAL;
  if (device.device.has_ranges) {
    if (ret->index != 0) return EINVAL;
    ret->type = V4L2_FRMIVAL_TYPE_STEPWISE;
    ret->stepwise.min = {1, 120};
    ret->stepwise.max = {1, 1};
    ret->stepwise.step = {1, 120};
    return 0;
  }
  for (const FakeSize& size : format->sizes) {
    if (size.width != static_cast<int>(ret->width) || size.height != static_cast<int>(ret->height)) continue;
    if (ret->index >= size.rates.size()) return EINVAL;
    ret->type = V4L2_FRMIVAL_TYPE_DISCRETE;
    ret->discrete = interval_of(size.rates[ret->index]);
    return 0;
  }
  return EINVAL;
}

int set_format(Device* device, v4l2_format* ret) {
  if (device->is_taken || !device->buffers.empty()) return EBUSY;
  v4l2_pix_format& pixels = ret->fmt.pix;
  // An unknown format is replaced by a known one, as in the kernel.
  if (format_of(*device, pixels.pixelformat) == nullptr) pixels.pixelformat = device->device.formats[0].fourcc;
  const FakeFormat& format = *format_of(*device, pixels.pixelformat);
  if (!device->device.has_ranges) {
    const bool is_listed = std::any_of(format.sizes.begin(), format.sizes.end(), [&](const FakeSize& size) {
      return size.width == static_cast<int>(pixels.width) && size.height == static_cast<int>(pixels.height);
    });
    if (!is_listed) {
      pixels.width = format.sizes.empty() ? 640U : static_cast<std::uint32_t>(format.sizes[0].width);
      pixels.height = format.sizes.empty() ? 480U : static_cast<std::uint32_t>(format.sizes[0].height);
    }
  }
  const bool is_jpeg = pixels.pixelformat == V4L2_PIX_FMT_MJPEG;
  const auto row = static_cast<std::uint32_t>(pixels.width * bytes_per_pixel(pixels.pixelformat));
  pixels.bytesperline = is_jpeg ? 0 : row + device->device.row_padding;
  const bool is_planar = pixels.pixelformat == V4L2_PIX_FMT_NV12;
  pixels.sizeimage =
      is_jpeg ? 2 * row * pixels.height : (row + device->device.row_padding) * pixels.height * (is_planar ? 3 : 2) / 2;
  device->format = pixels;
  return 0;
}

int set_interval(Device* device, v4l2_streamparm* ret) {
  v4l2_fract& interval = ret->parm.capture.timeperframe;
  if (interval.numerator == 0 || interval.denominator == 0) interval = {1, 30};
  device->interval = interval;
  return 0;
}

int query_control(const Device& device, v4l2_queryctrl* ret) {
  const auto found = device.device.controls.find(ret->id);
  if (found == device.device.controls.end()) return EINVAL;
  ret->minimum = static_cast<std::int32_t>(found->second.min);
  ret->maximum = static_cast<std::int32_t>(found->second.max);
  ret->step = static_cast<std::int32_t>(found->second.step);
  return 0;
}

int get_control(const Device& device, v4l2_control* ret) {
  const auto found = device.device.controls.find(ret->id);
  if (found == device.device.controls.end()) return EINVAL;
  ret->value = static_cast<std::int32_t>(found->second.value);
  return 0;
}

int set_control(Device* device, const v4l2_control& wanted) {
  const auto found = device->device.controls.find(wanted.id);
  if (found == device->device.controls.end()) return EINVAL;
  if (wanted.value < found->second.min || wanted.value > found->second.max) return ERANGE;
  found->second.value = wanted.value;
  return 0;
}

int request_buffers(FakeVideo* video, Device* device, int fd, v4l2_requestbuffers* ret) {
  if (device->is_taken || (device->owner_fd != -1 && device->owner_fd != fd)) return EBUSY;
  video->free_buffers(device);
  if (ret->count == 0) return 0;
  if (device->format.sizeimage == 0) return EINVAL;
  device->owner_fd = fd;
  for (std::uint32_t i = 0; i < ret->count; ++i) {
    FakeVideo::Buffer buffer;
    buffer.memory.reset(::memfd_create("picture", MFD_CLOEXEC));
    CHECK(::ftruncate(buffer.memory.get(), device->format.sizeimage) == 0);
    device->buffers.push_back(std::move(buffer));
  }
  return 0;
}

int query_buffer(const Device& device, v4l2_buffer* ret) {
  if (ret->index >= device.buffers.size()) return EINVAL;
  ret->length = device.format.sizeimage;
  ret->m.offset = ret->index << 26U;
  return 0;
}

int queue_buffer(Device* device, int fd, const v4l2_buffer& buffer) {
  if (device->owner_fd != fd || buffer.index >= device->buffers.size()) return EINVAL;
  if (device->buffers[buffer.index].is_queued) return EINVAL;
  device->buffers[buffer.index].is_queued = true;
  device->queued.push_back(buffer.index);
  return 0;
}

int dequeue_buffer(Device* device, int fd, v4l2_buffer* ret) {
  if (device->owner_fd != fd || !device->is_streaming) return EINVAL;
  if (device->filled.empty()) return EAGAIN;
  const std::uint32_t index = device->filled.front();
  device->filled.pop_front();
  device->buffers[index].is_queued = false;
  *ret = device->buffers[index].filled;
  return 0;
}

int export_buffer(FakeVideo* video, Device* device, v4l2_exportbuffer* ret) {
  if (!device->device.exports_dma_bufs) return ENOTTY;
  if (ret->index >= device->buffers.size()) return EINVAL;
  ret->fd = ::fcntl(device->buffers[ret->index].memory.get(), F_DUPFD_CLOEXEC, 0);
  video->exported.insert(ret->fd);
  return 0;
}

int stream(FakeVideo* video, Device* device, int fd, bool is_on) {
  if (device->is_taken || (device->owner_fd != fd && device->owner_fd != -1)) return EBUSY;
  if (device->buffers.empty()) return EINVAL;
  device->is_streaming = is_on;
  device->sequence = 0;
  device->next_at = video->clock().now() + std::chrono::milliseconds(10);
  if (!is_on) {
    device->queued.clear();
    device->filled.clear();
    for (FakeVideo::Buffer& buffer : device->buffers) buffer.is_queued = false;
  }
  return 0;
}

int take_event(Device* device, v4l2_event* ret) {
  if (!device->has_event) return ENOENT;
  device->has_event = false;
  *ret = {};
  ret->type = V4L2_EVENT_SOURCE_CHANGE;
  return 0;
}

const char* name_of(unsigned long code) {
  switch (code) {
#define NAMED(request) \
  case request:        \
    return #request;
    NAMED(VIDIOC_QUERYCAP)
    NAMED(VIDIOC_ENUM_FMT)
    NAMED(VIDIOC_ENUM_FRAMESIZES)
    NAMED(VIDIOC_ENUM_FRAMEINTERVALS)
    NAMED(VIDIOC_G_FMT)
    NAMED(VIDIOC_S_FMT)
    NAMED(VIDIOC_S_PARM)
    NAMED(VIDIOC_QUERY_DV_TIMINGS)
    NAMED(VIDIOC_S_DV_TIMINGS)
    NAMED(VIDIOC_SUBSCRIBE_EVENT)
    NAMED(VIDIOC_DQEVENT)
    NAMED(VIDIOC_QUERYCTRL)
    NAMED(VIDIOC_G_CTRL)
    NAMED(VIDIOC_S_CTRL)
    NAMED(VIDIOC_REQBUFS)
    NAMED(VIDIOC_QUERYBUF)
    NAMED(VIDIOC_QBUF)
    NAMED(VIDIOC_DQBUF)
    NAMED(VIDIOC_EXPBUF)
    NAMED(VIDIOC_STREAMON)
    NAMED(VIDIOC_STREAMOFF)
#undef NAMED
    default:
      return "?";
  }
}

}  // namespace

int FakeVideo::request(DeviceState* device, int fd, unsigned long code, void* argument) {
  // Requests that free resources never fail, because the kernel frees the resources whatever it returns.
  const bool frees =
      code == VIDIOC_STREAMOFF || (code == VIDIOC_REQBUFS && static_cast<v4l2_requestbuffers*>(argument)->count == 0);
  if (!frees) {
    if (const int error = meet(name_of(code)); error != 0) return error;
    if (!device->is_plugged) return ENODEV;
  }
  const bool is_grabber = device->device.is_grabber;
  switch (code) {
    case VIDIOC_QUERYCAP:
      return query_capability(*device, static_cast<v4l2_capability*>(argument));
    case VIDIOC_ENUM_FMT:
      return list_format(*device, static_cast<v4l2_fmtdesc*>(argument));
    case VIDIOC_ENUM_FRAMESIZES:
      return list_size(*device, static_cast<v4l2_frmsizeenum*>(argument));
    case VIDIOC_ENUM_FRAMEINTERVALS:
      return list_interval(*device, static_cast<v4l2_frmivalenum*>(argument));
    case VIDIOC_G_FMT:
      static_cast<v4l2_format*>(argument)->fmt.pix.width = 640;
      static_cast<v4l2_format*>(argument)->fmt.pix.height = 480;
      return 0;
    case VIDIOC_S_FMT:
      return set_format(device, static_cast<v4l2_format*>(argument));
    case VIDIOC_S_PARM:
      return set_interval(device, static_cast<v4l2_streamparm*>(argument));
    case VIDIOC_QUERY_DV_TIMINGS:
      return !is_grabber ? ENOTTY : device->device.has_signal ? 0 : ENOLINK;
    case VIDIOC_S_DV_TIMINGS:
      return is_grabber ? 0 : ENOTTY;
    case VIDIOC_SUBSCRIBE_EVENT:
      return 0;
    case VIDIOC_DQEVENT:
      return take_event(device, static_cast<v4l2_event*>(argument));
    case VIDIOC_QUERYCTRL:
      return query_control(*device, static_cast<v4l2_queryctrl*>(argument));
    case VIDIOC_G_CTRL:
      return get_control(*device, static_cast<v4l2_control*>(argument));
    case VIDIOC_S_CTRL:
      return set_control(device, *static_cast<v4l2_control*>(argument));
    case VIDIOC_REQBUFS:
      return request_buffers(this, device, fd, static_cast<v4l2_requestbuffers*>(argument));
    case VIDIOC_QUERYBUF:
      return query_buffer(*device, static_cast<v4l2_buffer*>(argument));
    case VIDIOC_QBUF:
      return queue_buffer(device, fd, *static_cast<v4l2_buffer*>(argument));
    case VIDIOC_DQBUF:
      return dequeue_buffer(device, fd, static_cast<v4l2_buffer*>(argument));
    case VIDIOC_EXPBUF:
      return export_buffer(this, device, static_cast<v4l2_exportbuffer*>(argument));
    case VIDIOC_STREAMON:
      return stream(this, device, fd, true);
    case VIDIOC_STREAMOFF:
      return stream(this, device, fd, false);
    default:
      return ENOTTY;
  }
}

}  // namespace cyclorama
