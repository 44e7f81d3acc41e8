// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "drivers/output/drm/gpu_context.h"
#include "drivers/output/gl_objects.h"

namespace cyclorama::output {

/// A framebuffer id on the card that scans it out. Move-only; borrows the card's fd.
class KmsFramebuffer {
 public:
  KmsFramebuffer() = default;
  /// Makes a framebuffer from a buffer of the card that `gpu` renders on; another card imports it as a DMA-buf. Errors:
  /// from errno.
  static Result<KmsFramebuffer> make(const GpuContext& gpu, const Card& card, gbm_bo* buffer);
  KmsFramebuffer(KmsFramebuffer&& other) noexcept : fd_(other.fd_), id_(std::exchange(other.id_, 0)) {}
  KmsFramebuffer& operator=(KmsFramebuffer&& other) noexcept {
    std::swap(fd_, other.fd_);
    std::swap(id_, other.id_);
    return *this;
  }
  /// A framebuffer that cannot be removed is freed with the file descriptor.
  ~KmsFramebuffer() {
    if (id_ != 0) drmModeRmFB(fd_, id_);
  }
  [[nodiscard]] std::uint32_t id() const { return id_; }

 private:
  int fd_ = -1;
  std::uint32_t id_ = 0;
};

/// One of the two buffers of a connector: pixels that GL draws and the card scans out without a copy. GL's row 0 is the
/// TOP of the picture here. Move-only; borrows the GpuContext.
class Scanout {
 public:
  /// `format` is DRM_FORMAT_XRGB8888 or _XRGB2101010. Errors: kUnavailable, or from errno, if the driver does not
  /// support it.
  static Result<Scanout> make(const GpuContext& gpu, const Card& card, int width_px, int height_px,
                              std::uint32_t format);

  [[nodiscard]] GLuint gl_framebuffer() const { return gl_framebuffer_.id(); }
  [[nodiscard]] std::uint32_t kms_framebuffer() const { return kms_framebuffer_.id(); }

 private:
  GbmBuffer buffer_;  // First member, since the members below refer to it.
  EglImage image_;
  GlRenderbuffer renderbuffer_;
  GlFramebuffer gl_framebuffer_;
  KmsFramebuffer kms_framebuffer_;
};

}  // namespace cyclorama::output
