// SPDX-License-Identifier: Apache-2.0
#include "drivers/camera/v4l2/video_device.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <system_error>

#include "common/base/text.h"
#include "drivers/camera/v4l2/pixel_formats.h"
#include "drivers/camera/v4l2/stepped_range.h"

namespace cyclorama::camera {
namespace {

/// Bounds enumeration for a driver that never reports the end of a list.
constexpr std::uint32_t kMaxEntries = 256;

/// Reads a fixed field of a kernel structure, which need not be null-terminated.
template <std::size_t N>
std::string text_of(const unsigned char (&field)[N]) {
  const auto* const bytes = reinterpret_cast<const char*>(field);
  return printable({bytes, ::strnlen(bytes, N)}, N);
}

double rate_of(const v4l2_fract& interval) {
  return interval.numerator == 0 ? 0.0 : static_cast<double>(interval.denominator) / interval.numerator;
}

/// Returns the width or height of a stepped range that is nearest to `requested`.
int nearest(std::uint32_t min, std::uint32_t max, std::uint32_t step, int requested) {
  return static_cast<int>(nearest_step(min, max, step, requested));
}

}  // namespace

bool device_call(int fd, unsigned long request, void* argument) {
  int result = 0;
  do {
    result = ::ioctl(fd, request, argument);
  } while (result != 0 && errno == EINTR);
  return result == 0;
}

Error device_error(const std::string& doing, SourceLine where) {
  const int error = errno;
  const std::string what = doing + ": " + std::generic_category().message(error);
  switch (error) {
    case ENODEV:
    case ENXIO:
    case EPIPE:
      return {ErrorCode::kUnavailable, what + " (unplugged?)", where};
    case EIO:
      return {ErrorCode::kUnavailable, what + " (a bad cable, or the device hangs: plug it in again)", where};
    case EBUSY:
      return {ErrorCode::kBusy, what + "; another program uses the camera: `fuser -v /dev/video*` tells which", where};
    case ENOSPC:
      return {ErrorCode::kUnavailable,
              what + "; the USB bus has no room for its pictures: plug it into another port, or ask for less", where};
    case EACCES:
    case EPERM:
      return {ErrorCode::kSystem, what + "; its user must be in the group 'video'", where};
    default:
      errno = error;
      return Error::from_errno(doing, where);
  }
}

std::string VideoDevice::named(const std::string& doing) const {
  return fmt::format("camera at {} ({}): {}", port_, path_, doing);
}

Result<VideoDevice> VideoDevice::open(const std::string& path) {
  VideoDevice device;
  device.path_ = path;
  // Non-blocking, since poll() limits the waiting time for a picture.
  device.fd_.reset(::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC));
  if (!device.fd_.is_open()) return device_error(fmt::format("opening the camera '{}'", path));
  v4l2_capability capability{};
  if (!device_call(device.fd(), VIDIOC_QUERYCAP, &capability)) {
    if (errno == ENOTTY || errno == EINVAL) return Error(ErrorCode::kNotFound, fmt::format("'{}' is no camera", path));
    return device_error(fmt::format("querying the capabilities of '{}'", path));
  }
  struct stat status {};
  if (::fstat(device.fd(), &status) == 0) device.number_ = status.st_rdev;
  device.name_ = text_of(capability.card);
  device.port_ = text_of(capability.bus_info);
  const std::uint32_t can =
      (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? capability.device_caps : capability.capabilities;
  if ((can & V4L2_CAP_VIDEO_CAPTURE) == 0 || (can & V4L2_CAP_STREAMING) == 0) {
    const bool is_planar = (can & V4L2_CAP_VIDEO_CAPTURE_MPLANE) != 0;
    return Error(ErrorCode::kNotFound,
                 device.named(is_planar ? "is one part of a camera that only libcamera can drive; try libcamera:"
                                        : "does not capture video; of a camera's several nodes another one does"));
  }
  return device;
}

Result<std::vector<PictureOffer>> VideoDevice::offers(const PicturePreference& preferred) const {
  std::vector<PictureOffer> offers;
  for (std::uint32_t index = 0; index < kMaxEntries; ++index) {
    v4l2_fmtdesc format{};
    format.index = index;
    format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (!device_call(fd(), VIDIOC_ENUM_FMT, &format)) {
      if (errno == EINVAL) break;
      return device_error(named("listing its formats"));
    }
    const auto layout = layout_of_v4l2(format.pixelformat);
    if (layout) add_sizes(format.pixelformat, *layout, preferred, &offers);
  }
  return offers;
}

void VideoDevice::add_sizes(std::uint32_t fourcc, PixelLayout layout, const PicturePreference& preferred,
                            std::vector<PictureOffer>* ret_offers) const {
  const bool is_coloured = colour_of_v4l2(fourcc).chroma != Chroma::kNone;
  for (std::uint32_t index = 0; index < kMaxEntries; ++index) {
    v4l2_frmsizeenum size{};
    size.index = index;
    size.pixel_format = fourcc;
    if (!device_call(fd(), VIDIOC_ENUM_FRAMESIZES, &size)) {
      // A driver that lists no sizes has exactly one: that of its signal.
      v4l2_format now{};
      now.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
      if (index == 0 && device_call(fd(), VIDIOC_G_FMT, &now)) {
        add_rates({fourcc, layout, static_cast<int>(now.fmt.pix.width), static_cast<int>(now.fmt.pix.height), 0.0,
                   is_coloured},
                  preferred, ret_offers);
      }
      return;
    }
    if (size.type == V4L2_FRMSIZE_TYPE_DISCRETE) {
      add_rates({fourcc, layout, static_cast<int>(size.discrete.width), static_cast<int>(size.discrete.height), 0.0,
                 is_coloured},
                preferred, ret_offers);
      continue;
    }
    const v4l2_frmsize_stepwise& range = size.stepwise;
    add_rates({fourcc, layout, nearest(range.min_width, range.max_width, range.step_width, preferred.width_px),
               nearest(range.min_height, range.max_height, range.step_height, preferred.height_px), 0.0, is_coloured},
              preferred, ret_offers);
    return;
  }
}

void VideoDevice::add_rates(PictureOffer offer, const PicturePreference& preferred,
                            std::vector<PictureOffer>* ret_offers) const {
  for (std::uint32_t index = 0; index < kMaxEntries; ++index) {
    v4l2_frmivalenum interval{};
    interval.index = index;
    interval.pixel_format = offer.fourcc;
    interval.width = static_cast<std::uint32_t>(offer.width_px);
    interval.height = static_cast<std::uint32_t>(offer.height_px);
    if (!device_call(fd(), VIDIOC_ENUM_FRAMEINTERVALS, &interval)) {
      if (index == 0) ret_offers->push_back(offer);
      return;
    }
    if (interval.type == V4L2_FRMIVAL_TYPE_DISCRETE) {
      offer.frames_per_second = rate_of(interval.discrete);
      ret_offers->push_back(offer);
      continue;
    }
    const double slowest = rate_of(interval.stepwise.max);
    const double quickest = std::max(slowest, rate_of(interval.stepwise.min));
    offer.frames_per_second = std::clamp(preferred.frames_per_second, slowest, quickest);
    ret_offers->push_back(offer);
    return;
  }
}

Status VideoDevice::follow_signal() const {
  v4l2_dv_timings timings{};
  if (device_call(fd(), VIDIOC_QUERY_DV_TIMINGS, &timings)) {
    if (!device_call(fd(), VIDIOC_S_DV_TIMINGS, &timings)) return device_error(named("taking its signal's timings"));
    return Done{};
  }
  if (errno == ENOLINK || errno == ENOLCK || errno == ERANGE) {
    return Error(ErrorCode::kUnavailable, named("no usable signal at its input: is the camera on, and its cable in?"));
  }
  if (errno == ENODEV || errno == ENXIO) return device_error(named("querying its signal"));
  return Done{};  // A camera, not a frame grabber.
}

Result<PictureFormat> VideoDevice::set_format(const PictureOffer& offer) const {
  v4l2_format format{};
  format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  v4l2_pix_format& pixels = format.fmt.pix;
  pixels.width = static_cast<std::uint32_t>(offer.width_px);
  pixels.height = static_cast<std::uint32_t>(offer.height_px);
  pixels.pixelformat = offer.fourcc;
  pixels.field = V4L2_FIELD_NONE;
  if (!device_call(fd(), VIDIOC_S_FMT, &format)) return device_error(named("setting its format"));
  const auto layout = layout_of_v4l2(pixels.pixelformat);
  constexpr std::uint32_t kMaxPx = 1U << 15U;
  if (!layout || pixels.width == 0 || pixels.height == 0 || pixels.width > kMaxPx || pixels.height > kMaxPx) {
    return Error(ErrorCode::kBadData,
                 named(fmt::format("answers {}x{} {} when asked for {}", pixels.width, pixels.height,
                                   fourcc_text(pixels.pixelformat), describe(offer))));
  }
  PictureFormat made{pixels.pixelformat,
                     *layout,
                     static_cast<int>(pixels.width),
                     static_cast<int>(pixels.height),
                     pixels.bytesperline,
                     colour_of_v4l2(pixels.pixelformat)};
  std::uint32_t range = pixels.quantization;
  if (range == V4L2_QUANTIZATION_DEFAULT) {
    range = static_cast<std::uint32_t>(V4L2_MAP_QUANTIZATION_DEFAULT(false, pixels.colorspace, pixels.ycbcr_enc));
  }
  made.colour.is_full_range = range == V4L2_QUANTIZATION_FULL_RANGE;
  // Some drivers do not report the row length.
  made.row_bytes = std::max(made.row_bytes, static_cast<std::size_t>(pixels.width) * bytes_per_pixel(*layout));
  return made;
}

Result<std::optional<double>> VideoDevice::set_rate(double frames_per_second) const {
  v4l2_streamparm parameters{};
  parameters.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  v4l2_fract& interval = parameters.parm.capture.timeperframe;
  interval.numerator = 1000;
  interval.denominator = static_cast<std::uint32_t>(std::lround(1000.0 * frames_per_second));
  if (!device_call(fd(), VIDIOC_S_PARM, &parameters)) {
    if (errno == ENOTTY || errno == EINVAL) return std::optional<double>{};
    return device_error(named("setting its rate"));
  }
  const double rate = rate_of(interval);
  return rate > 0.0 ? std::optional(rate) : std::nullopt;
}

void VideoDevice::subscribe_to_source_changes() const {
  v4l2_event_subscription wanted{};
  wanted.type = V4L2_EVENT_SOURCE_CHANGE;
  static_cast<void>(device_call(fd(), VIDIOC_SUBSCRIBE_EVENT, &wanted));
}

bool VideoDevice::took_source_change() const {
  v4l2_event event{};
  return device_call(fd(), VIDIOC_DQEVENT, &event) && event.type == V4L2_EVENT_SOURCE_CHANGE;
}

std::optional<DeviceControl> VideoDevice::control(std::uint32_t id) const {
  v4l2_queryctrl asked{};
  asked.id = id;
  if (!device_call(fd(), VIDIOC_QUERYCTRL, &asked)) return std::nullopt;
  if ((asked.flags & (V4L2_CTRL_FLAG_DISABLED | V4L2_CTRL_FLAG_READ_ONLY)) != 0) return std::nullopt;
  v4l2_control value{};
  value.id = id;
  if (!device_call(fd(), VIDIOC_G_CTRL, &value)) return std::nullopt;
  return DeviceControl{id, asked.minimum, asked.maximum, std::max(asked.step, 1), value.value};
}

Result<bool> VideoDevice::set_control(std::uint32_t id, long value) const {
  v4l2_control wanted{};
  wanted.id = id;
  wanted.value = static_cast<std::int32_t>(value);
  if (device_call(fd(), VIDIOC_S_CTRL, &wanted)) return true;
  if (errno == ENODEV || errno == ENXIO) return device_error(named("setting a control"));
  return false;
}

}  // namespace cyclorama::camera
