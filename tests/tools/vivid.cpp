// SPDX-License-Identifier: Apache-2.0
#include "tests/tools/vivid.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstring>
#include <string_view>

namespace cyclorama {
namespace {

constexpr int kWidth = 640;
constexpr int kHeight = 480;
constexpr std::uint32_t kBuffers = 3;
constexpr std::uint32_t kType = V4L2_BUF_TYPE_VIDEO_OUTPUT;

Status ask(int fd, unsigned long code, void* argument, const char* doing) {
  if (::ioctl(fd, code, argument) == 0) return Done{};
  return Error::from_errno(doing);
}

/// Opens vivid's node with this capability.
Result<UniqueFd> open_node(std::uint32_t capability, std::string* ret_path = nullptr) {
  for (int number = 0; number < 16; ++number) {
    const std::string path = fmt::format("/dev/video{}", number);
    UniqueFd fd(::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC));
    v4l2_capability found{};
    if (!fd.is_open() || ::ioctl(fd.get(), VIDIOC_QUERYCAP, &found) != 0) continue;
    if (std::string_view(reinterpret_cast<const char*>(found.driver)) != "vivid") continue;
    if ((found.device_caps & capability) == 0) continue;
    if (ret_path != nullptr) *ret_path = path;
    return fd;
  }
  return Error(ErrorCode::kNotFound, "the driver vivid is not loaded, or not plugged in");
}

Status set_control_of(int fd, const std::string& name, int value) {
  v4l2_query_ext_ctrl control{};
  control.id = V4L2_CTRL_FLAG_NEXT_CTRL;
  while (::ioctl(fd, VIDIOC_QUERY_EXT_CTRL, &control) == 0) {
    if (name == control.name) {
      v4l2_control wanted{control.id, value};
      return ask(fd, VIDIOC_S_CTRL, &wanted, name.c_str());
    }
    control.id |= V4L2_CTRL_FLAG_NEXT_CTRL;
  }
  return Error(ErrorCode::kNotFound, fmt::format("vivid has no control '{}'", name));
}

/// Selects 640x480 at 60 per second from the driver's list.
Status set_timings(int fd) {
  v4l2_enum_dv_timings known{};
  while (::ioctl(fd, VIDIOC_ENUM_DV_TIMINGS, &known) == 0) {
    const v4l2_bt_timings& timings = known.timings.bt;
    if (timings.width == kWidth && timings.height == kHeight && timings.pixelclock / 1'000'000 == 25) {
      return ask(fd, VIDIOC_S_DV_TIMINGS, &known.timings, "setting the cable's timings");
    }
    ++known.index;
  }
  return Error(ErrorCode::kNotFound, "vivid knows no timings of 640x480");
}

Status set_size(int fd, bool is_output) {
  TRY(set_timings(fd));
  v4l2_format format{};
  format.type = is_output ? V4L2_BUF_TYPE_VIDEO_OUTPUT : V4L2_BUF_TYPE_VIDEO_CAPTURE;
  format.fmt.pix.width = kWidth;
  format.fmt.pix.height = kHeight;
  format.fmt.pix.pixelformat = V4L2_PIX_FMT_GREY;
  format.fmt.pix.field = V4L2_FIELD_NONE;
  TRY(ask(fd, VIDIOC_S_FMT, &format, "setting the cable's format"));
  if (format.fmt.pix.pixelformat != V4L2_PIX_FMT_GREY || format.fmt.pix.bytesperline != kWidth) {
    return Error(ErrorCode::kSystem, "vivid does not take grey pixels");
  }
  return Done{};
}

}  // namespace

Result<std::string> VividCable::input_path() {
  std::string path;
  TRY(open_node(V4L2_CAP_VIDEO_CAPTURE, &path));
  return path;
}

Status VividCable::set_control(const std::string& name, int value) {
  TRY_ASSIGN(const UniqueFd input, open_node(V4L2_CAP_VIDEO_CAPTURE));
  return set_control_of(input.get(), name, value);
}

Result<std::unique_ptr<VividCable>> VividCable::plug(const GreyImage& picture) {
  CHECK(picture.width() == kWidth && picture.height() == kHeight);
  std::unique_ptr<VividCable> cable(new VividCable());
  {
    TRY_ASSIGN(const UniqueFd input, open_node(V4L2_CAP_VIDEO_CAPTURE));
    TRY(set_size(input.get(), false));
    TRY(set_control_of(input.get(), "OSD Text Mode", 2));
  }
  TRY_ASSIGN(cable->output_, open_node(V4L2_CAP_VIDEO_OUTPUT));
  const int fd = cable->output_.get();
  TRY(set_size(fd, true));
  // Before Linux 6.11 this is one switch; later each input is connected to an output, by default the first to the
  // first.
  if (!VividCable::set_control("Loop Video", 1)) TRY(VividCable::set_control("HDMI 000-0 Is Connected To", 2));
  v4l2_requestbuffers wanted{};
  wanted.count = kBuffers;
  wanted.type = kType;
  wanted.memory = V4L2_MEMORY_MMAP;
  TRY(ask(fd, VIDIOC_REQBUFS, &wanted, "the cable's buffers"));
  for (std::uint32_t index = 0; index < wanted.count; ++index) {
    v4l2_buffer buffer{};
    buffer.index = index;
    buffer.type = kType;
    buffer.memory = V4L2_MEMORY_MMAP;
    TRY(ask(fd, VIDIOC_QUERYBUF, &buffer, "the cable's buffers"));
    void* const map = ::mmap(nullptr, buffer.length, PROT_READ | PROT_WRITE, MAP_SHARED, fd, buffer.m.offset);
    if (map == MAP_FAILED) return Error::from_errno("mapping the cable's buffers");
    cable->maps_.emplace_back(map, buffer.length);
    std::memcpy(map, picture.data().data(), picture.data().size());
    buffer.bytesused = static_cast<std::uint32_t>(picture.data().size());
    buffer.field = V4L2_FIELD_NONE;
    TRY(ask(fd, VIDIOC_QBUF, &buffer, "filling the cable"));
  }
  std::uint32_t type = kType;
  TRY(ask(fd, VIDIOC_STREAMON, &type, "starting the cable"));
  cable->thread_ = std::jthread([raw = cable.get()](const std::stop_token& stop) {
    if (const auto ended = raw->show(stop); !ended) fmt::print("cable: {}\n", ended.error().message());
  });
  return cable;
}

VividCable::~VividCable() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
  for (const auto& [map, length] : maps_) ::munmap(map, length);
}

Status VividCable::show(const std::stop_token& stop) {
  const int fd = output_.get();
  while (!stop.stop_requested()) {
    pollfd asked{fd, POLLOUT, 0};
    ::poll(&asked, 1, 100);
    v4l2_buffer buffer{};
    buffer.type = kType;
    buffer.memory = V4L2_MEMORY_MMAP;
    if (::ioctl(fd, VIDIOC_DQBUF, &buffer) != 0) {
      if (errno == EAGAIN) continue;
      return Error::from_errno("showing a picture");
    }
    // The same picture again: it is still in the buffer.
    buffer.bytesused = kWidth * kHeight;
    buffer.field = V4L2_FIELD_NONE;
    TRY(ask(fd, VIDIOC_QBUF, &buffer, "showing a picture"));
  }
  return Done{};
}

}  // namespace cyclorama
