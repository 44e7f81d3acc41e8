// SPDX-License-Identifier: Apache-2.0
#include "drivers/camera/v4l2/stream_buffers.h"

#include <fcntl.h>
#include <linux/dma-buf.h>
#include <linux/videodev2.h>
#include <sys/mman.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "drivers/camera/v4l2/video_device.h"

namespace cyclorama::camera {
namespace {

/// One being filled, one waiting to be filled, one being read, and one in reserve.
constexpr std::uint32_t kBuffers = 4;
/// With fewer buffers, the device would have none to fill during a read.
constexpr std::uint32_t kMinBuffers = 2;
constexpr std::uint32_t kType = V4L2_BUF_TYPE_VIDEO_CAPTURE;

v4l2_buffer buffer_of(std::uint32_t index) {
  v4l2_buffer buffer{};
  buffer.type = kType;
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.index = index;
  return buffer;
}

KernelStamp stamp_of(const v4l2_buffer& buffer) {
  KernelStamp stamp;
  stamp.is_monotonic = (buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  stamp.is_start_of_exposure = (buffer.flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  // A driver may write any value; times that would overflow are invalid.
  constexpr std::int64_t kMaxSeconds = std::int64_t{1} << 32;
  const std::int64_t seconds = buffer.timestamp.tv_sec;
  const std::int64_t microseconds = buffer.timestamp.tv_usec;
  if (seconds < 0 || seconds > kMaxSeconds || microseconds < 0 || microseconds >= 1'000'000) {
    stamp.is_monotonic = false;
    return stamp;
  }
  stamp.at = TimePoint(std::chrono::seconds(seconds) + std::chrono::microseconds(microseconds));
  return stamp;
}

}  // namespace

StreamBuffers::StreamBuffers(StreamBuffers&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)),
      has_buffers_(std::exchange(other.has_buffers_, false)),
      is_streaming_(std::exchange(other.is_streaming_, false)),
      buffers_(std::move(other.buffers_)) {
  other.buffers_.clear();
}

StreamBuffers::~StreamBuffers() {
  std::uint32_t type = kType;
  if (is_streaming_) device_call(fd_, VIDIOC_STREAMOFF, &type);
  for (Buffer& buffer : buffers_) {
    if (buffer.map != nullptr) ::munmap(buffer.map, buffer.length);
    buffer.dma_buf.reset();
  }
  if (!has_buffers_) return;
  v4l2_requestbuffers none{};
  none.type = kType;
  none.memory = V4L2_MEMORY_MMAP;
  device_call(fd_, VIDIOC_REQBUFS, &none);
}

Result<StreamBuffers> StreamBuffers::start(int device_fd, BufferMemory memory) {
  StreamBuffers made(device_fd);
  v4l2_requestbuffers wanted{};
  wanted.count = kBuffers;
  wanted.type = kType;
  wanted.memory = V4L2_MEMORY_MMAP;
  if (!device_call(device_fd, VIDIOC_REQBUFS, &wanted)) return device_error("requesting buffers");
  made.has_buffers_ = true;
  if (wanted.count < kMinBuffers) {
    return Error(ErrorCode::kUnavailable, "it has no memory for two pictures");
  }
  made.buffers_.resize(wanted.count);
  for (std::uint32_t index = 0; index < wanted.count; ++index) {
    TRY(made.map(index, memory));
    TRY(made.queue(index));
  }
  std::uint32_t type = kType;
  if (!device_call(device_fd, VIDIOC_STREAMON, &type)) return device_error("starting its stream");
  made.is_streaming_ = true;
  return made;
}

Status StreamBuffers::map(std::uint32_t index, BufferMemory memory) {
  v4l2_buffer asked = buffer_of(index);
  if (!device_call(fd_, VIDIOC_QUERYBUF, &asked)) return device_error("querying its buffers");
  Buffer& buffer = buffers_[index];
  buffer.length = asked.length;
  int source = fd_;
  off_t offset = asked.m.offset;
  if (memory == BufferMemory::kDmaBuf) {
    v4l2_exportbuffer exported{};
    exported.type = kType;
    exported.index = index;
    exported.flags = O_CLOEXEC | O_RDWR;
    if (!device_call(fd_, VIDIOC_EXPBUF, &exported)) {
      if (errno != ENOTTY && errno != EINVAL) return device_error("exporting its buffers");
      return Error(ErrorCode::kInvalidArgument, "its driver exports no DMA-bufs; leave out memory=dma_buf");
    }
    buffer.dma_buf.reset(exported.fd);
    source = exported.fd;
    offset = 0;
  }
  void* const mapped = ::mmap(nullptr, buffer.length, PROT_READ | PROT_WRITE, MAP_SHARED, source, offset);
  if (mapped == MAP_FAILED) return device_error("mapping its buffers");
  buffer.map = mapped;
  return Done{};
}

Status StreamBuffers::queue(std::uint32_t index) const {
  v4l2_buffer buffer = buffer_of(index);
  if (!device_call(fd_, VIDIOC_QBUF, &buffer)) return device_error("giving it a buffer");
  return Done{};
}

Result<std::optional<FilledBuffer>> StreamBuffers::take() {
  v4l2_buffer buffer = buffer_of(0);
  if (!device_call(fd_, VIDIOC_DQBUF, &buffer)) {
    if (errno == EAGAIN) return std::optional<FilledBuffer>{};
    return device_error("taking a picture");
  }
  if (buffer.index >= buffers_.size()) {
    return Error(ErrorCode::kUnavailable, "it answers with a buffer that it was never given");
  }
  FilledBuffer filled;
  filled.index = buffer.index;
  filled.bytes = std::min<std::size_t>(buffer.bytesused, buffers_[buffer.index].length);
  filled.is_damaged = (buffer.flags & V4L2_BUF_FLAG_ERROR) != 0;
  filled.sequence = buffer.sequence;
  filled.stamp = stamp_of(buffer);
  return std::optional(filled);
}

std::span<const std::byte> StreamBuffers::bytes(const FilledBuffer& filled) const {
  return {static_cast<const std::byte*>(buffers_[filled.index].map), filled.bytes};
}

Status StreamBuffers::give_back(const FilledBuffer& filled) { return queue(filled.index); }

void StreamBuffers::sync(const FilledBuffer& filled, bool begins) const {
  const UniqueFd& dma_buf = buffers_[filled.index].dma_buf;
  if (!dma_buf.is_open()) return;
  dma_buf_sync sync{};
  sync.flags = DMA_BUF_SYNC_READ | (begins ? DMA_BUF_SYNC_START : DMA_BUF_SYNC_END);
  // The call fails for memory that needs no synchronisation, which is harmless.
  static_cast<void>(device_call(dma_buf.get(), DMA_BUF_IOCTL_SYNC, &sync));
}

}  // namespace cyclorama::camera
