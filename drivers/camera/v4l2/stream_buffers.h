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

/// Access method for the driver's memory.
enum class BufferMemory {
  kMapped,  ///< mmap() of the device.
  kDmaBuf,  ///< Each buffer is a DMA-buf (VIDIOC_EXPBUF), which is mapped and can be shared.
};

/// A picture that the driver has filled; owned by the reader until give_back().
struct FilledBuffer {
  std::uint32_t index = 0;
  std::size_t bytes = 0;
  bool is_damaged = false;  ///< V4L2_BUF_FLAG_ERROR.
  std::uint32_t sequence = 0;
  KernelStamp stamp;
};

/// The buffers into which a device streams, and the streaming itself. The destructor stops the stream and frees the
/// buffers, maps and file descriptors in the order that the kernel requires, so that another program can open the
/// device. Borrows the device's file descriptor. Thread-bound.
class StreamBuffers {
 public:
  /// Errors: kBusy if another program streams; others are those of device_error().
  static Result<StreamBuffers> start(int device_fd, BufferMemory memory);
  StreamBuffers(StreamBuffers&& other) noexcept;
  StreamBuffers& operator=(StreamBuffers&&) = delete;
  ~StreamBuffers();

  /// Returns the oldest filled buffer, or nothing if there is none. Never blocks. Errors: kUnavailable if the stream is
  /// broken.
  Result<std::optional<FilledBuffer>> take();
  /// Returns the bytes that the driver wrote; valid until give_back().
  [[nodiscard]] std::span<const std::byte> bytes(const FilledBuffer& filled) const;
  /// Errors: kUnavailable if the stream is broken.
  Status give_back(const FilledBuffer& filled);
  /// Call begin_reading() before and end_reading() after reading bytes(). They synchronise the CPU caches with the
  /// memory that the device writes, which only DMA-bufs need.
  void begin_reading(const FilledBuffer& filled) const { sync(filled, true); }
  void end_reading(const FilledBuffer& filled) const { sync(filled, false); }
  /// Number of buffers. Once all of them are filled, the driver drops further pictures, and the newest one is stale.
  [[nodiscard]] std::size_t count() const { return buffers_.size(); }
  /// File descriptor of a buffer's DMA-buf, borrowed; -1 with kMapped.
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
