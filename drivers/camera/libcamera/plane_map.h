// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <span>
#include <utility>

#include "common/base/result.h"

namespace cyclorama::camera {

/// A part of a DMA-buf, mapped for reading. Thread-bound.
class PlaneMap {
 public:
  /// Errors: kSystem if mmap() fails.
  static Result<PlaneMap> map(int fd, std::size_t offset, std::size_t length) {
    PlaneMap made;
    // mmap() offsets must be page-aligned; plane offsets need not be, so the map starts at 0.
    made.length_ = offset + length;
    made.offset_ = offset;
    void* const mapped = ::mmap(nullptr, made.length_, PROT_READ, MAP_SHARED, fd, 0);
    if (mapped == MAP_FAILED) return Error::from_errno("mapping a camera's picture");
    made.map_ = mapped;
    return made;
  }
  PlaneMap(PlaneMap&& other) noexcept
      : map_(std::exchange(other.map_, nullptr)), length_(other.length_), offset_(other.offset_) {}
  PlaneMap& operator=(PlaneMap&&) = delete;
  ~PlaneMap() {
    if (map_ != nullptr) ::munmap(map_, length_);
  }
  [[nodiscard]] std::span<const std::byte> bytes() const {
    return std::span(static_cast<const std::byte*>(map_), length_).subspan(offset_);
  }

 private:
  PlaneMap() = default;
  void* map_ = nullptr;
  std::size_t length_ = 0;
  std::size_t offset_ = 0;
};

}  // namespace cyclorama::camera
