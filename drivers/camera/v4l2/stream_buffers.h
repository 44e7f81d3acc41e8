// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "common/base/unique_fd.h"
#include "drivers/camera/capture_time.h"

namespace cyclorama::camera {

/// How the driver's memory is seen.
enum class BufferMemory {
  kMapped,  ///< mmap() of the device.
  kDmaBuf,  ///< Each buffer is a DMA-buf (VIDIOC_EXPBUF), which another device can be given as well; we read it through
            ///< that.
};

/// A picture that the driver has filled, until give_back().
struct FilledBuffer {
  std::uint32_t index = 0;
  std::size_t bytes = 0;
  bool is_damaged = false;  ///< V4L2_BUF_FLAG_ERROR.
  std::uint32_t sequence = 0;
  KernelStamp stamp;
};

/// The memory that a device streams into, and the streaming itself. Frees all of it, in the kernel's order, when it
/// dies: no picture, map or file descriptor is left, so another program can have the device. Borrows the device's file
/// descriptor. Thread-bound.
class StreamBuffers {
 public:
  /// kBusy  another program streams. Others as device_error().
  static Result<StreamBuffers> start(int device_fd, BufferMemory memory);
  StreamBuffers(StreamBuffers&& other) noexcept;
  StreamBuffers& operator=(StreamBuffers&&) = delete;
  ~StreamBuffers();

  /// The oldest filled one; nothing when there is none now. Never blocks. kUnavailable  the stream is broken.
  Result<std::optional<FilledBuffer>> take();
  /// What the driver wrote. Valid until give_back().
  [[nodiscard]] std::span<const std::byte> bytes(const FilledBuffer& filled) const;
  /// kUnavailable  the stream is broken.
  Status give_back(const FilledBuffer& filled);
  /// Before and after bytes() are read: caches of memory that a device writes must be told. Only DMA-bufs need it.
  void begin_reading(const FilledBuffer& filled) const { sync(filled, true); }
  void end_reading(const FilledBuffer& filled) const { sync(filled, false); }
  /// How many the driver has in all. When that many are filled, it has stopped: the newest is then no longer new.
  [[nodiscard]] std::size_t count() const { return buffers_.size(); }
  /// The DMA-buf of a buffer, borrowed; -1 with kMapped.
  [[nodiscard]] int dma_buf(std::uint32_t index) const { return buffers_[index].dma_buf.get(); }

 private:
  struct Buffer {
    void* map = nullptr;
    std::size_t length = 0;
    UniqueFd dma_buf;
  };
  explicit StreamBuffers(int device_fd) : fd_(device_fd) {}
  Status map(std::uint32_t index, BufferMemory memory);
  Status queue(std::uint32_t index) const;
  void sync(const FilledBuffer& filled, bool begins) const;

  int fd_ = -1;
  bool has_buffers_ = false;
  bool is_streaming_ = false;
  std::vector<Buffer> buffers_;
};

}  // namespace cyclorama::camera
